// Reads the files of `octray rays --dump`, little-endian: rays, octray's hits, and triangles.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

constexpr uint32_t MISS = 0xffffffff;

struct Answers {
    std::vector<float> t; // infinite for a miss
    std::vector<uint32_t> primitive;

    explicit Answers(size_t count) : t(count, std::numeric_limits<float>::infinity()), primitive(count, MISS) {}
    bool hit(size_t ray) const { return primitive[ray] != MISS; }
    size_t hits() const {
        size_t sum = 0;
        for (uint32_t p : primitive) sum += p != MISS;
        return sum;
    }
};

struct Rays {
    std::string kind;
    bool any_hit; // shadow rays need any hit, not the closest
    size_t count;
    std::array<std::vector<float>, 3> origin, direction;
    std::vector<float> t_max;
    Answers octray;
};

using Triangle = std::array<std::array<float, 3>, 3>;

namespace dump {

class File {
public:
    File(const std::string& path, const char* magic) : path(path), stream(path, std::ios::binary) {
        char found[8] = {};
        stream.read(found, sizeof found);
        if (!stream) throw std::runtime_error(path + ": cannot be read; is it a folder that `octray rays SCENE --dump` wrote?");
        if (std::memcmp(found, magic, sizeof found) != 0)
            throw std::runtime_error(path + ": does not start with " + magic + "; dump it again with this version of octray");
        read(&count, 1);
    }
    template <class T> std::vector<T> column(size_t values) {
        // Checks the length of the file before allocating: a broken count is an error, not a crash.
        auto here = stream.tellg();
        stream.seekg(0, std::ios::end);
        if (values > static_cast<size_t>(stream.tellg() - here) / sizeof(T)) throw std::runtime_error(path + ": is cut short");
        stream.seekg(here);
        std::vector<T> column(values);
        read(column.data(), values);
        return column;
    }

    uint64_t count = 0;

private:
    template <class T> void read(T* into, size_t values) {
        stream.read(reinterpret_cast<char*>(into), static_cast<std::streamsize>(values * sizeof(T)));
        if (!stream) throw std::runtime_error(path + ": is cut short");
    }

    std::string path;
    std::ifstream stream;
};

inline Rays rays(const std::string& folder, const std::string& kind) {
    File file(folder + "/" + kind + ".rays", "OCTRAYS1");
    size_t n = file.count;
    Rays rays{kind, kind == "shadow", n, {}, {}, {}, Answers(0)};
    for (auto& axis : rays.origin) axis = file.column<float>(n);
    for (auto& axis : rays.direction) axis = file.column<float>(n);
    rays.t_max = file.column<float>(n);
    rays.octray.t = file.column<float>(n);
    rays.octray.primitive = file.column<uint32_t>(n);
    return rays; // u and v follow, unused here
}

inline std::vector<Triangle> triangles(const std::string& folder) {
    File file(folder + "/triangles.bin", "OCTRITR1");
    if (file.count >= MISS) throw std::runtime_error(folder + "/triangles.bin: more triangles than a u32 can number");
    auto numbers = file.column<float>(9 * file.count);
    std::vector<Triangle> triangles(file.count);
    std::memcpy(triangles.data(), numbers.data(), numbers.size() * sizeof(float));
    return triangles;
}

} // namespace dump
