// The whole library, bottom to top: the table of contents.
#pragma once

// core: numbers and shapes
#include <aglow/core/bounds.hpp>
#include <aglow/core/callback.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/halton.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/octahedral.hpp>
#include <aglow/core/packed_direction.hpp>
#include <aglow/core/packed_place.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/random.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/core/roulette.hpp>
#include <aglow/core/shared_exponent.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/simd_avx2.hpp>
#include <aglow/core/simd_avx512.hpp>
#include <aglow/core/simd_best.hpp>
#include <aglow/core/simd_pair.hpp>
#include <aglow/core/simd_sse.hpp>
#include <aglow/core/simd_tables.hpp>
#include <aglow/core/sobol.hpp>
#include <aglow/core/stereographic.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/core/version.hpp>
#include <aglow/core/warp.hpp>

// concepts: what a host brings
#include <aglow/concepts/intersector.hpp>
#include <aglow/concepts/lambert.hpp>
#include <aglow/concepts/light.hpp>
#include <aglow/concepts/sampler.hpp>
#include <aglow/concepts/spectrum.hpp>
#include <aglow/concepts/surface.hpp>

// containers: where things are
#include <aglow/containers/cell_directory.hpp>
#include <aglow/containers/kd_boxes.hpp>
#include <aglow/containers/kd_build.hpp>
#include <aglow/containers/kd_cloud.hpp>
#include <aglow/containers/kd_crowd.hpp>
#include <aglow/containers/kd_halve.hpp>
#include <aglow/containers/kd_kernels.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_median.hpp>
#include <aglow/containers/kd_nearest_one.hpp>
#include <aglow/containers/kd_probe.hpp>
#include <aglow/containers/kd_search.hpp>
#include <aglow/containers/kd_select.hpp>
#include <aglow/containers/kd_tree.hpp>
#include <aglow/containers/loose_octree.hpp>
#include <aglow/containers/octree.hpp>
#include <aglow/containers/packed_spheres.hpp>
#include <aglow/containers/sphere_search.hpp>
#include <aglow/containers/stable_array.hpp>

// estimators: light from what was stored
#include <aglow/estimators/compact_gradients.hpp>
#include <aglow/estimators/compact_photon.hpp>
#include <aglow/estimators/density.hpp>
#include <aglow/estimators/density_sum.hpp>
#include <aglow/estimators/edge_derivatives.hpp>
#include <aglow/estimators/estimate.hpp>
#include <aglow/estimators/frozen_irradiance_cache.hpp>
#include <aglow/estimators/hemisphere.hpp>
#include <aglow/estimators/irradiance_cache.hpp>
#include <aglow/estimators/irradiance_cache_options.hpp>
#include <aglow/estimators/irradiance_estimate.hpp>
#include <aglow/estimators/irradiance_gradients.hpp>
#include <aglow/estimators/irradiance_hessian.hpp>
#include <aglow/estimators/irradiance_points.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/kernel.hpp>
#include <aglow/estimators/linear_light.hpp>
#include <aglow/estimators/photon.hpp>
#include <aglow/estimators/photon_map.hpp>
#include <aglow/estimators/record_blend.hpp>
#include <aglow/estimators/record_lanes.hpp>
#include <aglow/estimators/record_neighbours.hpp>
#include <aglow/estimators/record_reach.hpp>
#include <aglow/estimators/record_sharing.hpp>
#include <aglow/estimators/record_view.hpp>

// algorithms: light on its way
#include <aglow/algorithms/cache_candidates.hpp>
#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/cache_layer.hpp>
#include <aglow/algorithms/caustic_light.hpp>
#include <aglow/algorithms/direct_light.hpp>
#include <aglow/algorithms/energy_ledger.hpp>
#include <aglow/algorithms/fill_cache.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/final_gather.hpp>
#include <aglow/algorithms/gather.hpp>
#include <aglow/algorithms/gloss_layer.hpp>
#include <aglow/algorithms/host_faults.hpp>
#include <aglow/algorithms/incoming_light.hpp>
#include <aglow/algorithms/layered_integrator.hpp>
#include <aglow/algorithms/layers.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/path_walk.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/photon_options.hpp>
#include <aglow/algorithms/photon_source.hpp>
#include <aglow/algorithms/photon_walk.hpp>
#include <aglow/algorithms/pixel_probe.hpp>
#include <aglow/algorithms/plan.hpp>
#include <aglow/algorithms/precompute_irradiance.hpp>
#include <aglow/algorithms/preparation.hpp>
#include <aglow/algorithms/progressive.hpp>
#include <aglow/algorithms/stiffness.hpp>
#include <aglow/algorithms/trace_photons.hpp>

// report: how good is it
#include <aglow/report/audit.hpp>
#include <aglow/report/audit_pixels.hpp>
#include <aglow/report/audit_result.hpp>
#include <aglow/report/audit_sample.hpp>
#include <aglow/report/bias_variance.hpp>
#include <aglow/report/bootstrap.hpp>
#include <aglow/report/claim_plan.hpp>
#include <aglow/report/confidence.hpp>
#include <aglow/report/conformal.hpp>
#include <aglow/report/convergence.hpp>
#include <aglow/report/decay.hpp>
#include <aglow/report/distributions.hpp>
#include <aglow/report/image_error.hpp>
#include <aglow/report/image_view.hpp>
#include <aglow/report/probe.hpp>
#include <aglow/report/probe_reader.hpp>
#include <aglow/report/quantiles.hpp>
#include <aglow/report/render_until.hpp>
#include <aglow/report/running_mean.hpp>
#include <aglow/report/statement.hpp>
#include <aglow/report/tails.hpp>
