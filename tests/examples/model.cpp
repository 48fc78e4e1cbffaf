#include "common/model.hpp"

#include <stdlib.h>  // mkdtemp

#include <filesystem>
#include <fstream>
#include <string>

#include "common/image_io.hpp"
#include "common/model_scene.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"

namespace {

namespace fs = std::filesystem;
using aglow::lobe_set;

/// Files of this test's own, gone afterwards.
struct files {
    std::string pattern = (fs::temp_directory_path() / "aglow_model_XXXXXX").string();
    fs::path folder{::mkdtemp(pattern.data())};
    ~files() { fs::remove_all(folder); }

    fs::path write(const std::string& name, const std::string& text) const {
        std::ofstream{folder / name} << text;
        return folder / name;
    }
};

constexpr const char* materials = R"(newmtl matte
Kd 0.8 0.4 0.2
newmtl shiny
Kd 0.3 0.3 0.3
Ks 0.5 0.4 0.3
Ns 62
newmtl chrome
Kd 0 0 0
Ks 0.9 0.9 0.9
Ns 1000
illum 3
newmtl window
Kd 0 0 0
d 0.1
Ni 1.45
illum 7
newmtl lamp
Kd 0 0 0
Ke 5 6 7
)";

std::string quad(int first, const std::string& material) {
    const auto n = [first](int i) { return std::to_string(first + i); };
    return "usemtl " + material + "\nf " + n(0) + " " + n(1) + " " + n(2) + " " + n(3) + "\n";
}

/// A unit square at height `y`, its normal upwards.
std::string square(int y) {
    const std::string h = std::string{" "}.append(std::to_string(y)).append(" ");
    return "v 0" + h + "0\nv 0" + h + "1\nv 1" + h + "1\nv 1" + h + "0\n";
}

const host::material<float>& made_of(const host::model& m, std::size_t mesh) {
    return m.materials[m.meshes[mesh].material];
}

}  // namespace

TEST_CASE("model: OBJ materials become diffuse, glossy, mirror, glass and light") {
    const files dir;
    dir.write("m.mtl", materials);
    std::string text = "mtllib m.mtl\n";
    const char* names[] = {"matte", "shiny", "chrome", "window", "lamp"};
    for (int i = 0; i < 5; ++i) { text += square(i) + quad(4 * i + 1, names[i]); }
    const host::model m = host::read_model(dir.write("m.obj", text));
    REQUIRE(m.meshes.size() == 5);
    for (std::size_t i = 0; i < 5; ++i) {
        const host::material<float>& made = made_of(m, i);
        const float y = m.meshes[i].corners.front().y;
        const lobe_set lobes = host::lobes_of(made);
        if (y == 0) {
            CHECK(lobes == lobe_set::diffuse_reflection);
            CHECK(made.diffuse == aglow::vec3<float>{0.8f, 0.4f, 0.2f});
        }
        if (y == 1) {
            CHECK(lobes == (lobe_set::diffuse_reflection | lobe_set::glossy_reflection));
            CHECK(made.roughness == Approx(std::sqrt(2.0 / 64)));
        }
        if (y == 2) { CHECK(lobes == lobe_set::specular_reflection); }
        if (y == 3) { CHECK(made.index == Approx(1.45f)); }
        if (y == 4) { CHECK(made.radiance == aglow::vec3<float>{5, 6, 7}); }
    }
    const host::model_scene scene{m};
    // Pi times the area times the radiance.
    CHECK(scene.lights().power().x == Approx(5 * aglow::pi<double>));
    CHECK(laws::emitter(scene.lights(), scene.lights().power(), {.samples = 5000}).ok);
    const auto v = laws::intersector(scene, scene.bounds());
    INFO(v.message);
    CHECK(v.ok);
    const auto met = laws::illuminator_meets_rays(scene.lights(), scene, aglow::vec3<float>{0.4f, 3.7f, 0.6f},
                                                  aglow::vec3<float>{0, 1, 0}, {.samples = 5000});
    INFO(met.message);
    CHECK(met.ok);
}

TEST_CASE("model: glTF brings metal, roughness, emission, a lamp and a camera") {
    const files dir;
    // One triangle: three positions and three indices, in base 64.
    const std::string text =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],"extensionsUsed":["KHR_lights_punctual"],
"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","color":[1,0.5,0.25],"intensity":8}]}},
"nodes":[{"mesh":0},{"camera":0,"translation":[1,2,3]},
{"translation":[4,5,6],"extensions":{"KHR_lights_punctual":{"light":0}}}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.8,"aspectRatio":1.5,"znear":0.1}}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.9,0.6,0.3,1],"metallicFactor":1,"roughnessFactor":0.5},
"emissiveFactor":[0.25,0.5,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]})";
    const host::model m = host::read_model(dir.write("t.gltf", text));
    REQUIRE(m.meshes.size() == 1);
    const host::material<float>& made = made_of(m, 0);
    CHECK(host::lobes_of(made) == lobe_set::glossy_reflection);
    CHECK(made.glossy.y == Approx(0.6f));
    CHECK(made.roughness == Approx(0.25f));
    CHECK(made.radiance.z == Approx(1));
    REQUIRE(m.lamps.size() == 1);
    CHECK(m.lamps[0].position == aglow::vec3<float>{4, 5, 6});
    CHECK(m.lamps[0].intensity == aglow::vec3<float>{8, 4, 2});
    REQUIRE(m.camera);
    CHECK(m.camera->origin == aglow::vec3<float>{1, 2, 3});
    CHECK(m.camera->forward.z == Approx(-1));
    CHECK(m.camera->tangent == Approx(std::tan(0.4)));
}

TEST_CASE("model: PLY without light or camera is framed whole under an even sky") {
    const files dir;
    const std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n10 0 0\n0 10 0\n0 0 10\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    const host::model m = host::read_model(dir.write("t.ply", text));
    REQUIRE(m.meshes.size() == 1);
    CHECK(m.meshes[0].triangles.size() == 4);
    const host::model_scene scene{m};
    CHECK(scene.lights().escaped({0, 1, 0}) == aglow::vec3<float>{1});
    for (const auto& corner : m.meshes[0].corners) { CHECK(scene.view().film_point(corner, 100, 100)); }
}

TEST_CASE("model: normals of a file shade its faces, and the surface keeps the laws") {
    const files dir;
    // A square whose corners lean outwards, as a patch of a dome would. Dark: at grazing angles photons come away with
    // |wo·Ns| / |wo·Ng| times what they brought, which is above one there for every surface that is shaded so.
    dir.write("m.mtl", "newmtl dark\nKd 0.3 0.3 0.3\n");
    const std::string text = "mtllib m.mtl\nusemtl dark\n" + square(0) +
                             "vn -0.3 1 -0.3\nvn -0.3 1 0.3\nvn 0.3 1 0.3\nvn 0.3 1 -0.3\n"
                             "f 1//1 2//2 3//3 4//4\n";
    const host::model_scene scene{host::read_model(dir.write("dome.obj", text))};
    const auto hit = scene.intersect({{0.25f, 1, 0.25f}, {0, -1, 0}});
    REQUIRE(hit);
    CHECK(hit->normal.y == Approx(1));
    // Between the corners' normals, of length one.
    const auto lean =
        glm::normalize(glm::vec3{-0.3f, 1, -0.3f}) * 0.75f + glm::normalize(glm::vec3{0.3f, 1, 0.3f}) * 0.25f;
    CHECK(glm::distance(hit->shading, glm::normalize(lean)) < 1e-4f);
    const auto v = laws::surface(*hit);
    INFO(v.message);
    CHECK(v.ok);
}

TEST_CASE("model: a coarse ball with a ball's normals is lit like a ball") {
    const files dir;
    std::string text;
    constexpr int rings = 8;
    constexpr int sectors = 16;
    for (int j = 0; j <= rings; ++j) {
        for (int i = 0; i < sectors; ++i) {
            const double theta = aglow::pi<double> * j / rings;
            const double phi = 2 * aglow::pi<double> * i / sectors;
            const std::string p = std::to_string(std::sin(theta) * std::cos(phi)) + " " +
                                  std::to_string(std::cos(theta)) + " " +
                                  std::to_string(std::sin(theta) * std::sin(phi)) + "\n";
            text += "v " + p + "vn " + p;
        }
    }
    const auto corner = [](int j, int i) {
        const std::string n = std::to_string(j * sectors + i % sectors + 1);
        return " " + n + "//" + n;
    };
    for (int j = 0; j < rings; ++j) {
        for (int i = 0; i < sectors; ++i) {
            text += "f" + corner(j, i) + corner(j, i + 1) + corner(j + 1, i + 1) + corner(j + 1, i) + "\n";
        }
    }
    const host::model_scene scene{host::read_model(dir.write("ball.obj", text))};
    aglow::random_sampler<float> random{5};
    double worst_smooth = 0;
    double worst_flat = 0;
    for (int i = 0; i < 2000; ++i) {
        const aglow::vec3<float> out = aglow::uniform_sphere(random.next_2d());
        // Where triangles are small and no ball's cosine is near zero.
        if (std::abs(out.y) > 0.8f || out.x < 0.3f) { continue; }
        const auto hit = scene.intersect({out * 3.0f, -out});
        REQUIRE(hit);
        const aglow::vec3<float> to_light{1, 0, 0};
        // Lambert: radiance goes with the cosine of the true normal.
        const double lit = double(hit->evaluate(out, to_light, lobe_set::all).x * glm::dot(hit->normal, to_light));
        const double truth = 0.6 / aglow::pi<double> * double(glm::dot(out, to_light));
        const double flat = 0.6 / aglow::pi<double> * double(glm::dot(hit->normal, to_light));
        worst_smooth = std::max(worst_smooth, std::abs(lit / truth - 1));
        worst_flat = std::max(worst_flat, std::abs(flat / truth - 1));
    }
    CAPTURE(worst_smooth, worst_flat);
    // Straight lines between normals 22.5 degrees apart are off by their angle's cube; faces by up to half of it.
    CHECK(worst_smooth < 0.1);
    CHECK(worst_flat > 0.3);
}

TEST_CASE("model: a file without normals keeps the edges of a box, and smooths what is nearly flat") {
    const files dir;
    // A ridge of 20 degrees along z, and a step of 90 degrees at its foot.
    const std::string text =
        "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nv 2 -0.364 1\nv 2 -0.364 0\nv 0 -1 0\nv 0 -1 1\n"
        "f 1 2 3 4\nf 4 3 5 6\nf 7 8 2 1\n";
    const host::model_scene scene{host::read_model(dir.write("ridge.obj", text))};
    const auto above = [&](float x) { return scene.intersect({{x, 1, 0.5f}, {0, -1, 0}}); };
    REQUIRE(above(0.02f));
    REQUIRE(above(0.98f));
    // At the step the top's own normal, at the ridge the middle of both.
    CHECK(above(0.02f)->shading.y == Approx(1).epsilon(1e-3));
    CHECK(above(0.98f)->shading.x == Approx(std::sin(aglow::pi<double> / 18)).epsilon(0.1));
}

TEST_CASE("model: a face looks to the side of its normals, whatever the order of its corners") {
    const files dir;
    dir.write("m.mtl", materials);
    // Clockwise from above, but normals say up.
    const std::string text = "mtllib m.mtl\n" + square(0) + "vn 0 1 0\nusemtl lamp\nf 4//1 3//1 2//1 1//1\n";
    const host::model_scene scene{host::read_model(dir.write("m.obj", text))};
    const auto hit = scene.intersect({{0.25f, 1, 0.25f}, {0, -1, 0}});
    REQUIRE(hit);
    CHECK(hit->normal.y == Approx(1));
    CHECK(hit->emitted({0, 1, 0}) == aglow::vec3<float>{5, 6, 7});
    CHECK(hit->emitted({0, -1, 0}) == aglow::vec3<float>{0});
    aglow::random_sampler<float> random{1};
    CHECK(scene.lights().illuminate({0.5f, 2, 0.5f}, random));
    CHECK_FALSE(scene.lights().illuminate({0.5f, -2, 0.5f}, random));
}

TEST_CASE("model: a PNG colours the matte part, upright, and a missing one is noted and leaves it plain") {
    if (!host::has_png()) { return; }
    const files dir;
    host::picture four{2, 2};
    four.at(0, 0) = {1, 0, 0};  // top left
    four.at(1, 0) = {0, 1, 0};
    four.at(0, 1) = {0, 0, 1};
    four.at(1, 1) = {1, 1, 1};
    host::write_png(dir.folder / "four.png", four);
    dir.write("m.mtl",
              "newmtl painted\nKd 0.5 0.5 0.5\nmap_Kd four.png\nnewmtl lost\nKd 0.5 0.25 0.125\nmap_Kd none.png\n");
    // Looked at from above with +z towards the viewer's feet, u goes right with x, v up against z.
    const std::string text =
        "mtllib m.mtl\nv 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nvt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\n"
        "usemtl painted\nf 1/1 2/2 3/3 4/4\n" +
        square(-1) + "usemtl lost\nf 5/1 6/2 7/3 8/4\n";
    const host::model m = host::read_model(dir.write("m.obj", text));
    REQUIRE(m.notes.size() == 1);
    CHECK(m.notes[0].find("none.png") != std::string::npos);
    const host::model_scene scene{m};
    const aglow::vec3<float> up{0, 1, 0};
    const auto matte = [&](float x, float y, float z) {
        const auto hit = scene.intersect({{x, y, z}, -up});
        REQUIRE(hit);
        return hit->evaluate(up, up, lobe_set::all) * aglow::pi<float>;
    };
    CHECK(glm::distance(matte(0.25f, 1, 0.25f), {0.5f, 0, 0}) < 1e-4f);
    CHECK(glm::distance(matte(0.75f, 1, 0.25f), {0, 0.5f, 0}) < 1e-4f);
    CHECK(glm::distance(matte(0.25f, 1, 0.75f), {0, 0, 0.5f}) < 1e-4f);
    // Half-way between two pixels is their mean; beyond the edge the picture repeats.
    CHECK(glm::distance(matte(0.5f, 1, 0.25f), {0.25f, 0.25f, 0}) < 1e-4f);
    CHECK(glm::distance(matte(0.001f, 1, 0.25f), {0.25f, 0.25f, 0}) < 0.01f);
    CHECK(glm::distance(matte(0.25f, -0.5f, 0.25f), {0.5f, 0.25f, 0.125f}) < 1e-6f);
}

TEST_CASE("model: a material file that is missing is told by name") {
    const files dir;
    const host::model m = host::read_model(dir.write("m.obj", "mtllib gone.mtl\n" + square(0) + quad(1, "lost")));
    REQUIRE_FALSE(m.notes.empty());
    CHECK(m.notes[0] == "Unable to locate material file gone.mtl");
    CHECK(host::read_model(dir.write("plain.obj", square(0) + "f 1 2 3 4\n")).notes.empty());
}

TEST_CASE("model: a lamp's strength is read, or told to be left out") {
    const files dir;
    // A triangle within the file: three corners, one after another.
    const std::string text = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"extensionsUsed":["KHR_materials_emissive_strength"],
"materials":[{"emissiveFactor":[1,1,1],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":20}}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
    const host::model m = host::read_model(dir.write("m.gltf", text));
    REQUIRE(m.meshes.size() == 1);
    const float radiance = m.materials[m.meshes[0].material].radiance.x;
    if (m.notes.empty()) {
        CHECK(radiance == 20);
    } else {
        CHECK(radiance == 1);
        CHECK(m.notes[0].find("KHR_materials_emissive_strength") == 0);
    }
}

TEST_CASE("model: colours of corners run over the face") {
    const files dir;
    const std::string text = "v 0 0 0 1 0 0\nv 0 0 1 1 0 0\nv 1 0 1 0 0 1\nv 1 0 0 0 0 1\nf 1 2 3 4\n";
    const host::model_scene scene{host::read_model(dir.write("m.obj", text))};
    const aglow::vec3<float> up{0, 1, 0};
    const auto hit = scene.intersect({{0.25f, 1, 0.5f}, -up});
    REQUIRE(hit);
    const auto matte = hit->evaluate(up, up, lobe_set::all) * aglow::pi<float>;
    CHECK(glm::distance(matte, {0.9f * 0.75f, 0, 0.9f * 0.25f}) < 1e-4f);
}

TEST_CASE("model: a file that is none is refused by name") {
    const files dir;
    const auto refusal = [](const fs::path& file) {
        try {
            static_cast<void>(host::read_model(file));
        } catch (const std::runtime_error& e) { return std::string{e.what()}; }
        return std::string{};
    };
    const fs::path broken = dir.write("broken.gltf", "{\"asset\":");
    CHECK(refusal(broken).find(broken.string()) != std::string::npos);
    const fs::path empty = dir.write("empty.obj", "v 0 0 0\n");
    CHECK(refusal(empty).find(empty.string()) != std::string::npos);
    CHECK_FALSE(refusal(dir.folder / "missing.obj").empty());
}
