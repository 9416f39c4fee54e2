#pragma once

// Meshes, and the files that they make in every format.

#include "scene/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

namespace tristim::test {

struct TestMesh {
    std::vector<V3f> positions;
    std::vector<V3f> normals;
    std::vector<std::vector<int>> faces;
};

/// A pyramid over a square: one quadrilateral and four triangles, coordinates that need all digits of a float.
inline TestMesh pyramid(bool with_normals) {
    TestMesh mesh;
    const float a = 1.0f / 3.0f;
    mesh.positions = {{a, a, 0}, {-a, a, 0}, {-a, -a, 0}, {a, -a, 0}, {0, 0, 0.7654321f}};
    if (with_normals) {
        for (const V3f& position : mesh.positions)
            mesh.normals.push_back((position - V3f(0, 0, 0.2f)).normalized());
    }
    mesh.faces = {{3, 2, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    return mesh;
}

inline std::string ply_header(const TestMesh& mesh, const std::string& form) {
    std::string header = fmt::format("ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
                                     "property float z\n",
                                     form, mesh.positions.size());
    if (!mesh.normals.empty())
        header += "property float nx\nproperty float ny\nproperty float nz\n";
    return header +
           fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.faces.size());
}

inline std::string ascii_ply(const TestMesh& mesh) {
    std::string text = ply_header(mesh, "ascii");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const V3f& p = mesh.positions[i];
        text += fmt::format("{} {} {}", p.x, p.y, p.z);
        if (!mesh.normals.empty())
            text += fmt::format(" {} {} {}", mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z);
        text += "\n";
    }
    for (const auto& face : mesh.faces)
        text += fmt::format("{} {}\n", face.size(), fmt::join(face, " "));
    return text;
}

template <typename T>
void append(std::string& bytes, T value, bool big_endian) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big_endian == (std::endian::native == std::endian::little))
        std::reverse(raw.begin(), raw.end());
    for (const char byte : raw)
        bytes.push_back(byte);
}

inline std::string binary_ply(const TestMesh& mesh, bool big_endian) {
    std::string bytes = ply_header(mesh, big_endian ? "binary_big_endian" : "binary_little_endian");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis)
            append(bytes, mesh.positions[i][axis], big_endian);
        for (int axis = 0; axis < 3 && !mesh.normals.empty(); ++axis)
            append(bytes, mesh.normals[i][axis], big_endian);
    }
    for (const auto& face : mesh.faces) {
        append(bytes, static_cast<unsigned char>(face.size()), big_endian);
        for (const int vertex : face)
            append(bytes, vertex, big_endian);
    }
    return bytes;
}

inline std::string obj(const TestMesh& mesh) {
    std::string text = "# a pyramid\no pyramid\n";
    for (const V3f& p : mesh.positions)
        text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    for (const V3f& n : mesh.normals)
        text += fmt::format("vn {} {} {}\n", n.x, n.y, n.z);
    for (const auto& face : mesh.faces) {
        text += "f";
        for (const int vertex : face)
            text += mesh.normals.empty() ? fmt::format(" {}", vertex + 1) : fmt::format(" {0}//{0}", vertex + 1);
        text += "\n";
    }
    return text;
}

template <typename Uv>
std::string binary_ply_with_uv(const char* type, bool big_endian) {
    std::string bytes =
        fmt::format("ply\nformat binary_{0}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                    "property float z\nproperty {1} u\nproperty {1} v\nelement face 1\n"
                    "property list uchar int vertex_indices\nend_header\n",
                    big_endian ? "big" : "little", type);
    for (int i = 0; i < 3; ++i) {
        for (const float x : {i == 1 ? 1.0F : 0.0F, i == 2 ? 1.0F : 0.0F, 2.0F})
            append(bytes, x, big_endian);
        append(bytes, static_cast<Uv>(0.5 * i), big_endian);
        append(bytes, static_cast<Uv>(3 - i), big_endian);
    }
    append(bytes, static_cast<unsigned char>(3), big_endian);
    for (const int vertex : {0, 1, 2})
        append(bytes, vertex, big_endian);
    return bytes;
}

} // namespace tristim::test
