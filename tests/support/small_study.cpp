#include "tests/support/small_study.h"

#include "core/file.h"
#include "core/text.h"

namespace underbody::test {

namespace {

/// Across y from `left` to `right`; a side face closes it on the right, and on the left unless it is cut there.
std::string field_of_cube(double gap, double gradient, double left, double right, bool cut) {
    using core::format_number;
    constexpr double half = 0.05;
    const auto block = [&](const std::string& name, const std::string& nodes, const std::string& faces) {
        return "\n[Name]\n" + name +
               "\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ], Wall Shear X [ Pa ], Wall Shear Y [ Pa ], Wall "
               "Shear Z [ Pa ]\n" +
               nodes + "\n[Faces]\n" + faces;
    };
    const auto node = [&](double x, double y, double z) {
        return format_number(x) + ", " + format_number(y) + ", " + format_number(gap + z) + ", " +
               format_number(100 - gradient * z) + ", 0, 0, 0\n";
    };
    std::string corners;
    for (const double z : {0.0, 2 * half}) {
        corners += node(-half, left, z) + node(half, left, z) + node(half, right, z) + node(-half, right, z);
    }
    std::string bottom = node(-half, left, 0) + node(half, left, 0) + node(half, right, 0) + node(-half, right, 0);
    return block("base", bottom, "0, 3, 2, 1\n") +
           block("hull", corners,
                 std::string("4, 5, 6, 7\n") + (cut ? "" : "0, 1, 5, 4\n") + "1, 2, 6, 5\n2, 3, 7, 6\n3, 0, 4, 7\n");
}

}  // namespace

std::string cube_field(double gap, double gradient) { return field_of_cube(gap, gradient, -0.05, 0.05, false); }
std::string half_cube_field(double gap, double gradient) { return field_of_cube(gap, gradient, 0, 0.05, true); }

void write_small_study(const std::filesystem::path& folder) {
    std::string forces = "gap [mm], lift_force [N], drag_force [N]\n";
    for (int gap = 1; gap <= 6; ++gap) {
        const double lift = (7 - gap) / 10.0;
        core::write_file(folder / "fields" / ("cube-h" + std::to_string(gap) + ".csv"),
                         cube_field(1e-3 * gap, lift / 1e-3));
        forces += std::to_string(gap) + ", " + core::format_number(lift) + ", 0\n";
    }
    core::write_file(folder / "forces.csv", forces);
    core::write_file(
        folder / "glide.toml",
        "[vehicle]\nmass = \"2 kg\"\nadded_mass_heave = \"2 kg\"\nnet_weight = \"0.35 N\"\n"
        "[drag.heave]\nlinear = \"0.5 N s/m\"\nquadratic = \"10 N s^2/m^2\"\n[conditions]\nspeed = \"0.5 m/s\"\n");
    core::write_file(
        folder / "study.toml",
        "title = \"a cube\"\n"
        "[[case]]\nfiles = \"fields/{variant}-h{gap:mm}.csv\"\nconditions.speed = \"0.5 m/s\"\n"
        "[[verify]]\nname = \"solver\"\ntable = \"forces.csv\"\nquantities = [\"lift_force\", \"drag_force\"]\n"
        "[[table]]\nname = \"lift\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\nwhere = { variant = \"cube\", speed "
        "= 0.5 }\n"
        "net_weight = \"0.35 N\"\nvirtual_mass = \"4 kg\"\nexports = [\"c\", \"csv\"]\n"
        "[[region]]\nname = \"map\"\nmodel = \"glide.toml\"\nforces = [\"lift\"]\n"
        "axes = \"gap=1mm:6mm,heave_velocity=-0.02:0.02\"\nfor = \"20 s\"\ncolumns = 40\nrows = 40\n");
}

}  // namespace underbody::test
