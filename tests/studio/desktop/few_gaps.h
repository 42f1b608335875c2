// A study of five cases of the shipped one, for tests of the desktop.
#pragma once

#include <filesystem>

#include "core/file.h"
#include "tests/support/support.h"

namespace underbody::test {

/// A study of a few cases of the shipped one, small enough to be computed in a test.
inline void make_few_gaps(const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    const fs::path shipped = source_folder() / "cases" / "evie";
    fs::create_directories(folder / "fields");
    for (const char* gap : {"2", "3", "5", "10", "20"}) {
        const std::string name = std::string("ellipse-h") + gap + "-p0.csv";
        fs::copy_file(shipped / "fields" / name, folder / "fields" / name);
    }
    fs::copy_file(shipped / "glide.toml", folder / "glide.toml");
    fs::create_directories(folder / "shapes");
    fs::copy_file(shipped / "shapes" / "ellipse.toml", folder / "shapes" / "ellipse.toml");
    core::write_file(folder / "study.toml", R"(title = "A few gaps"
summary = "Five cases of the shipped study."
origin = "see cases/evie/ORIGIN.md"

[frame]
forward = "+x"
up = "+z"
symmetry = "y"

[reference]
length = "203.2 mm"
width = "152 mm"
height = "145 mm"
density = "998 kg/m^3"

[[body]]
name = "ellipse"
shape = "shapes/ellipse.toml"

[[case]]
files = "fields/{variant}-h{gap:mm}-p{pitch:deg}.csv"
conditions = { speed = "0.5 m/s" }

[[table]]
name = "lift"
quantity = "lift_force"
axes = ["gap"]
where = { variant = "ellipse", pitch = 0, speed = "0.5 m/s" }
net_weight = "0.30 N"
virtual_mass = "3.954 kg"

[[region]]
name = "glide"
model = "glide.toml"
forces = ["lift"]
axes = "gap=2mm:20mm,heave_velocity=-0.06:0.06"
for = "20 s"
columns = 40
rows = 40
)");
}

}  // namespace underbody::test
