// A surface of as many faces as one likes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace underbody::test {

/// A bumpy ellipsoid of `faces` triangles, binary.
inline void write_stl(const std::filesystem::path& path, int faces) {
    const int rings = static_cast<int>(std::sqrt(faces / 4.0));
    const auto at = [&](int i, int j) {
        const double theta = M_PI * i / rings, phi = M_PI * j / rings;
        const double r = 1 + 0.02 * std::sin(9 * theta) * std::cos(7 * phi);
        return std::array<float, 3>{static_cast<float>(200 * r * std::sin(theta) * std::cos(phi)),
                                    static_cast<float>(120 * r * std::sin(theta) * std::sin(phi)),
                                    static_cast<float>(90 * r * std::cos(theta))};
    };
    std::string bytes(80, ' ');
    std::string body;
    std::uint32_t count = 0;
    const auto add = [&](const std::array<std::array<float, 3>, 3>& corners) {
        const std::array<float, 3> normal{};
        body.append(reinterpret_cast<const char*>(normal.data()), 12);
        for (const auto& corner : corners) {
            body.append(reinterpret_cast<const char*>(corner.data()), 12);
        }
        body.append(2, '\0');
        ++count;
    };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < 2 * rings; ++j) {
            const int k = (j + 1) % (2 * rings);
            if (i > 0) {
                add({at(i, j), at(i + 1, j), at(i, k)});
            }
            if (i + 1 < rings) {
                add({at(i, k), at(i + 1, j), at(i + 1, k)});
            }
        }
    }
    bytes.append(reinterpret_cast<const char*>(&count), 4);
    std::ofstream(path, std::ios::binary) << bytes << body;
}

}  // namespace underbody::test
