#include "common/model.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

#include <assimp/GltfMaterial.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>

#include <aglow/core/bounds.hpp>

#include "common/image_io.hpp"

namespace host {
namespace {

using colour = vec3<float>;

colour limited(const aiColor4D& c, float most = 1) {
    const auto channel = [most](float x) { return x > 0 ? std::min(x, most) : 0.0f; };
    return {channel(c.r), channel(c.g), channel(c.b)};
}

vec3<float> point(const aiVector3D& p) { return {p.x, p.y, p.z}; }

/// A property of a material; `otherwise` where the file does not say.
float number(const aiMaterial& m, const char* key, unsigned type, unsigned index, float otherwise) {
    float value = otherwise;
    return m.Get(key, type, index, value) == aiReturn_SUCCESS ? value : otherwise;
}
colour shade(const aiMaterial& m, const char* key, unsigned type, unsigned index, const aiColor4D& otherwise,
             float most = 1) {
    aiColor4D value = otherwise;
    return limited(m.Get(key, type, index, value) == aiReturn_SUCCESS ? value : otherwise, most);
}

/// A gloss of width `alpha`; below what the facets allow it is a mirror.
void set_gloss(material<float>& made, const colour& reflectance, float alpha) {
    if (alpha > 0.002f) {
        made.glossy = reflectance;
        made.roughness = std::min(alpha, 1.0f);
    } else {
        made.mirror = reflectance;
    }
}

/// glTF 2.0, appendix B: metals reflect their colour, others 4 % above a diffuse base.
material<float> physically_based(const aiMaterial& m) {
    const colour base = shade(m, AI_MATKEY_BASE_COLOR, {1, 1, 1, 1});
    const float metal = std::clamp(number(m, AI_MATKEY_METALLIC_FACTOR, 1), 0.0f, 1.0f);
    const float rough = number(m, AI_MATKEY_ROUGHNESS_FACTOR, 1);
    material<float> made;
    if (number(m, AI_MATKEY_TRANSMISSION_FACTOR, 0) > 0.5f) {
        made.index = std::max(1.0f, number(m, AI_MATKEY_REFRACTI, 1.5f));
        return made;
    }
    made.diffuse = base * (0.96f * (1 - metal));
    set_gloss(made, colour{0.04f * (1 - metal)} + base * metal, rough * rough);
    return made;
}

/// Wavefront's Kd, Ks, Ns, d, Ni and illum.
material<float> phong_like(const aiMaterial& m) {
    const colour specular = shade(m, AI_MATKEY_COLOR_SPECULAR, {0, 0, 0, 1});
    const float opacity = number(m, AI_MATKEY_OPACITY, 1);
    const float index = number(m, AI_MATKEY_REFRACTI, 1);
    int illum = 0;
    m.Get("$mat.illum", 0, 0, illum);
    material<float> made;
    if ((opacity < 0.5f && index > 1) || illum == 4 || illum == 6 || illum == 7) {
        made.index = index > 1 ? index : 1.5f;
        return made;
    }
    made.diffuse = shade(m, AI_MATKEY_COLOR_DIFFUSE, {0.6f, 0.6f, 0.6f, 1});
    // Blinn's exponent as a width of facets (Walter et al. 2007, section 5).
    const float exponent = std::max(0.0f, number(m, AI_MATKEY_SHININESS, 0));
    const float alpha = illum == 3 || illum == 5 ? 0 : std::sqrt(2 / (exponent + 2));
    if (!aglow::is_black(specular) && exponent > 0) { set_gloss(made, specular, alpha); }
    return made;
}

/// Scales what reflects more than it receives down to what is possible.
void make_possible(material<float>& made) {
    const float sum = aglow::max_component(made.diffuse + made.glossy + made.mirror);
    if (sum <= 1) { return; }
    const float share = 0.9999f / sum;
    made.diffuse *= share;
    made.glossy *= share;
    made.mirror *= share;
}

material<float> converted(const aiMaterial& m) {
    float metal = 0;
    const bool physical = m.Get(AI_MATKEY_METALLIC_FACTOR, metal) == aiReturn_SUCCESS;
    material<float> made = physical ? physically_based(m) : phong_like(m);
    const float strength = number(m, AI_MATKEY_EMISSIVE_INTENSITY, 1);
    made.radiance = shade(m, AI_MATKEY_COLOR_EMISSIVE, {0, 0, 0, 1}, 1e6f) * strength;
    make_possible(made);
    return made;
}

/// Turns a triangle so that it faces the side of its normals: files disagree about the order of corners.
void face_normals(std::array<std::uint32_t, 3>& t, const model::mesh& mesh) {
    const auto& c = mesh.corners;
    const vec3<float> face = glm::cross(c[t[1]] - c[t[0]], c[t[2]] - c[t[0]]);
    const vec3<float> told = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
    if (glm::dot(face, told) < 0) { std::swap(t[1], t[2]); }
}

void add_corners(model::mesh& made, const aiMesh& mesh, const aiMatrix4x4& place) {
    // Normals go by the inverse transposed, so that they stay upright on what is stretched.
    const aiMatrix3x3 turn = aiMatrix3x3{place}.Inverse().Transpose();
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        made.corners.push_back(point(place * mesh.mVertices[i]));
        made.normals.push_back(mesh.HasNormals() ? point(turn * mesh.mNormals[i]) : vec3<float>{0});
        if (mesh.HasVertexColors(0)) { made.colours.push_back(limited(mesh.mColors[0][i])); }
        if (mesh.HasTextureCoords(0)) {
            made.places.push_back({mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y});
        }
    }
}

/// The material of a mesh that brings its own colours: white below them, but for what a clean surface swallows.
std::size_t whitened(model& into, std::size_t material) {
    host::material<float> own = into.materials[material];
    own.diffuse = colour{0.9f};
    make_possible(own);
    into.materials.push_back(own);
    into.textures.push_back(into.textures[material]);
    return into.materials.size() - 1;
}

void add_mesh(model& into, const aiMesh& mesh, const aiMatrix4x4& place) {
    model::mesh made{.material = mesh.mMaterialIndex};
    add_corners(made, mesh, place);
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
        const aiFace& f = mesh.mFaces[i];
        if (f.mNumIndices != 3) { continue; }
        made.triangles.push_back({f.mIndices[0], f.mIndices[1], f.mIndices[2]});
        face_normals(made.triangles.back(), made);
    }
    if (made.triangles.empty()) { return; }
    if (!made.colours.empty()) { made.material = whitened(into, made.material); }
    into.meshes.push_back(std::move(made));
}

void add_node(model& into, const aiScene& scene, const aiNode& node, const aiMatrix4x4& above) {
    const aiMatrix4x4 place = above * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) { add_mesh(into, *scene.mMeshes[node.mMeshes[i]], place); }
    for (unsigned i = 0; i < node.mNumChildren; ++i) { add_node(into, scene, *node.mChildren[i], place); }
}

/// Where a named light or camera stands: the product of its node's and all parents' transformations.
aiMatrix4x4 place_of(const aiScene& scene, const aiString& name) {
    aiMatrix4x4 place;
    for (const aiNode* n = scene.mRootNode->FindNode(name); n; n = n->mParent) { place = n->mTransformation * place; }
    return place;
}

void add_lights(model& into, const aiScene& scene) {
    for (unsigned i = 0; i < scene.mNumLights; ++i) {
        const aiLight& light = *scene.mLights[i];
        if (light.mType != aiLightSource_POINT) {
            into.notes.push_back(std::string{"light "} + light.mName.C_Str() +
                                 ": left out, only point lights are read");
            continue;
        }
        const aiMatrix4x4 place = place_of(scene, light.mName);
        const aiColor3D& c = light.mColorDiffuse;
        into.lamps.push_back({{place.a4, place.b4, place.c4}, limited({c.r, c.g, c.b, 1}, 1e9f)});
    }
}

/// The tangent of half the angle from top to bottom. Up to 5.2 assimp's glTF reader made the angle from side to side by
/// multiplying the other with the aspect, later by its tangent.
float half_tangent(const aiCamera& c) {
    const float aspect = c.mAspect > 0 ? c.mAspect : 1;
    const bool multiplied = aiGetVersionMajor() < 5 || (aiGetVersionMajor() == 5 && aiGetVersionMinor() <= 2);
    return multiplied ? std::tan(c.mHorizontalFOV / aspect / 2) : std::tan(c.mHorizontalFOV / 2) / aspect;
}

/// Of the formats read here glTF alone has cameras and lights. They stand where their node does; assimp says so a
/// second time in `mPosition`, which is not to be added.
std::optional<camera<float>> first_camera(const aiScene& scene) {
    if (scene.mNumCameras == 0) { return std::nullopt; }
    const aiCamera& c = *scene.mCameras[0];
    const aiMatrix4x4 place = place_of(scene, c.mName);
    const aiMatrix3x3 turn{place};
    const vec3<float> forward = glm::normalize(point(turn * c.mLookAt));
    const vec3<float> right = glm::normalize(glm::cross(forward, point(turn * c.mUp)));
    return camera<float>{.origin = {place.a4, place.b4, place.c4},
                         .forward = forward,
                         .up = glm::cross(right, forward),
                         .tangent = half_tangent(c)};
}

/// The picture that a material's diffuse part is multiplied by: a PNG beside the model, or within it.
picture texture_of(const aiScene& scene, const aiMaterial& m, const std::filesystem::path& folder) {
    aiString name;
    if (m.GetTexture(aiTextureType_DIFFUSE, 0, &name) != aiReturn_SUCCESS) { return {}; }
    const aiTexture* within = scene.GetEmbeddedTexture(name.C_Str());
    if (!within) { return read_png(folder / name.C_Str()); }
    // Compressed bytes have a width alone.
    if (within->mHeight != 0) { throw std::runtime_error("a texture within the file is not compressed"); }
    const auto* bytes = reinterpret_cast<const unsigned char*>(within->pcData);
    return read_png({bytes, within->mWidth}, std::string{"the texture "} + name.C_Str());
}

void add_materials(model& into, const aiScene& scene, const std::filesystem::path& folder) {
    for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
        into.materials.push_back(converted(*scene.mMaterials[i]));
        into.textures.emplace_back();
        try {
            into.textures.back() = texture_of(scene, *scene.mMaterials[i], folder);
        } catch (const std::runtime_error& e) { into.notes.push_back(std::string{"texture left out: "} + e.what()); }
    }
}

/// Keeps what assimp says that it did not find, for as long as it lives: material files above all, without which a
/// model comes out gray.
class listener {
public:
    explicit listener(std::vector<std::string>& notes) {
        Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
        Assimp::DefaultLogger::get()->attachStream(new stream{notes}, Assimp::Logger::Err | Assimp::Logger::Warn);
    }
    listener(const listener&) = delete;
    listener& operator=(const listener&) = delete;
    ~listener() { Assimp::DefaultLogger::kill(); }  // and the stream with it

private:
    struct stream : Assimp::LogStream {
        explicit stream(std::vector<std::string>& to) : notes{to} {}
        void write(const char* said) override {
            const std::string_view line{said};
            const std::size_t begin = line.find("nable to locate material file");
            if (begin == std::string_view::npos) { return; }
            notes.push_back("U" + std::string{line.substr(begin, line.find('\n') - begin)});
        }
        std::vector<std::string>& notes;
    };
};

/// Brighter glTF lamps than their factor says: an extension that assimp before 5.3 passes over in silence.
void note_unread_strength(model& into, const aiScene& scene, const std::filesystem::path& file) {
    const auto read = [](const aiMaterial* m) {
        float strength = 1;
        return m->Get(AI_MATKEY_EMISSIVE_INTENSITY, strength) == aiReturn_SUCCESS;
    };
    constexpr std::string_view extension = "KHR_materials_emissive_strength";
    if (std::any_of(scene.mMaterials, scene.mMaterials + scene.mNumMaterials, read)) { return; }
    std::ifstream bytes{file, std::ios::binary};
    const std::string text{std::istreambuf_iterator<char>{bytes}, {}};
    if (text.find(extension) == std::string::npos) { return; }
    into.notes.push_back(std::string{extension} +
                         ": not read by this version of assimp, lamps are as their factor says");
}

}  // namespace

model read_model(const std::filesystem::path& file) {
    model made;
    const listener ears{made.notes};
    Assimp::Importer importer;
    // Points and lines are no surfaces.
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    // Where a file has no normals, edges of more than 40 degrees stay edges.
    importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 40);
    const aiScene* scene =
        importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_GenSmoothNormals |
                                             aiProcess_JoinIdenticalVertices | aiProcess_FindDegenerates);
    if (!scene || !scene->mRootNode) {
        const std::string why = importer.GetErrorString();
        throw std::runtime_error("cannot read " + file.string() + ": " + why.substr(0, why.find('\n')));
    }
    add_materials(made, *scene, file.parent_path());
    add_node(made, *scene, *scene->mRootNode, aiMatrix4x4{});
    if (made.meshes.empty()) { throw std::runtime_error("cannot read " + file.string() + ": no triangles in it"); }
    add_lights(made, *scene);
    note_unread_strength(made, *scene, file);
    made.camera = first_camera(*scene);
    return made;
}

}  // namespace host
