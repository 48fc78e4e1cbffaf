#include "common/model.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include "common/model_scene.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"

namespace {

namespace fs = std::filesystem;
using aglow::lobe_set;

/// Files of this test's own, gone afterwards.
struct files {
    fs::path folder{fs::temp_directory_path() /
                    ("aglow_model_" + std::to_string(std::hash<std::string>{}(fs::current_path().string())))};
    files() { fs::create_directories(folder); }
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
