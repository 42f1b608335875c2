// Legacy Fluent files of our own making (tests/data/make_fluent_files.py), whole and damaged.
#include <gmock/gmock.h>
#include <vtkCellType.h>

#include <fstream>

#include "core/file.h"
#include "import_support.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using postproc::ReadOptions;
using ::testing::HasSubstr;

namespace {

constexpr double whole_volume = 1 + 1.25 + 0.5 + 1.0 / 3 + 0.25;

std::filesystem::path data(const std::string& name) { return test::data_folder() / "fluent_legacy" / name; }

/// The case of a name in a folder of its own, without the data beside it.
std::filesystem::path alone(const core::TemporaryFolder& folder, const std::string& bytes, const std::string& name) {
    std::ofstream(folder.path() / name, std::ios::binary) << bytes;
    return folder.path() / name;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

}  // namespace

TEST(FluentLegacy, EveryCodingGivesTheSameCellsForcesAndTractions) {
    for (const char* name :
         {"ascii.cas", "single.cas", "double.cas", "packed.cas.gz", "ascii.dat", "double.dat", "packed.dat.gz"}) {
        SCOPED_TRACE(name);
        const auto field = read_field(data(name));
        const auto* water = field.find("water");
        ASSERT_NE(water, nullptr);
        for (const int type : {VTK_HEXAHEDRON, VTK_POLYHEDRON, VTK_WEDGE, VTK_PYRAMID, VTK_TETRA}) {
            EXPECT_EQ(test::count_cells(*water->volume, type), 1) << type;
        }
        EXPECT_NEAR(test::volume_of(*water->volume), whole_volume, 1e-14);
        EXPECT_NEAR(test::smallest_volume(*water->volume), 0.25, 1e-14);
        // The gradient of the pressure is (2, 3, 4): by Gauss, the force on the hull is that times the volume.
        test::Triple force{};
        for (const char* zone : {"floor", "inlet", "body"}) {
            const auto part = test::pressure_force(*field.find(zone)->surface);
            for (std::size_t k = 0; k < 3; ++k) {
                force[k] += part[k];
            }
        }
        EXPECT_NEAR(force[0], 2 * whole_volume, 1e-5);
        EXPECT_NEAR(force[1], 3 * whole_volume, 1e-5);
        EXPECT_NEAR(force[2], 4 * whole_volume, 1e-5);
        const auto* body = field.find("body");
        const auto viscous = test::viscous_force(*body->surface);
        const double area = test::area_of(*body->surface);
        EXPECT_NEAR(viscous[0], 0.5 * area, 1e-6);
        EXPECT_NEAR(viscous[1], -0.25 * area, 1e-6);
        EXPECT_EQ(field.pressure.operating_pressure, 101325);
        EXPECT_EQ(field.density, 998.2);
        EXPECT_NE(body->find("y_plus"), nullptr);
        EXPECT_NE(body->find("SV_NEW_THING"), nullptr);
    }
}

TEST(FluentLegacy, ACaseCutAnywhereIsRefusedOrWhole) {
    for (const char* name : {"ascii.cas", "single.cas", "double.cas"}) {
        const std::string whole = core::read_file(data(name));
        const core::TemporaryFolder folder;
        for (std::size_t size = 1; size < whole.size(); size += 2) {
            const auto path = alone(folder, whole.substr(0, size), "cut.cas");
            try {
                const auto field = read_field(path);
                // Nothing but names of zones may be missing then.
                EXPECT_EQ(test::cells_of(field), 5) << name << " cut at " << size;
                EXPECT_NEAR(test::volume_of(field), whole_volume, 1e-12) << name << " cut at " << size;
            } catch (const core::InputError& error) {
                EXPECT_THAT(error.what(), HasSubstr("cut.cas"));
            }
        }
    }
}

TEST(FluentLegacy, DataCutAnywhereAreRefusedOrSayWhatIsMissing) {
    for (const char* name : {"ascii", "double"}) {
        const std::string whole = core::read_file(data(std::string(name) + ".dat"));
        const core::TemporaryFolder folder;
        ReadOptions options;
        options.companion = data(std::string(name) + ".cas");
        for (std::size_t size = 1; size < whole.size(); size += 5) {
            const auto path = alone(folder, whole.substr(0, size), "cut.dat");
            try {
                const auto field = read_field(path, options);
                const auto* body = field.find("body");
                const bool all = body != nullptr && body->find("pressure") != nullptr;
                bool told = all;
                for (const auto& problem : field.problems) {
                    told = told || problem.severity == core::Problem::Severity::warning;
                }
                EXPECT_TRUE(told) << name << " cut at " << size;
            } catch (const core::InputError&) {
                SUCCEED();
            }
        }
    }
}

TEST(FluentLegacy, ACutGzipFileIsRefused) {
    const std::string whole = core::read_file(data("packed.cas.gz"));
    const core::TemporaryFolder folder;
    for (std::size_t size = 20; size < whole.size(); size += 7) {
        EXPECT_NE(test::refusal(alone(folder, whole.substr(0, size), "cut.cas.gz")), "") << size;
    }
    std::string flipped = whole;
    flipped[flipped.size() - 6] = static_cast<char>(flipped[flipped.size() - 6] ^ 1);  // in the checksum
    EXPECT_THAT(test::refusal(alone(folder, flipped, "bad.cas.gz")), HasSubstr("damaged"));
}

TEST(FluentLegacy, WrongCountsAndIndicesAreRefusedWithTheirPlace) {
    const std::string whole = core::read_file(data("ascii.cas"));
    const core::TemporaryFolder folder;
    const auto reason = [&](const std::string& what, const std::string& by) {
        return test::refusal(alone(folder, replaced(whole, what, by), "wrong.cas"));
    };
    EXPECT_THAT(reason("(10 (0 1 12 0 3))", "(10 (0 1 13 0 3))"), HasSubstr("declares 19 nodes but holds 18"));
    EXPECT_THAT(reason("(13 (0 1 17 0))", "(13 (0 1 18 0))"), HasSubstr("24 faces"));
    EXPECT_THAT(reason("(12 (0 1 5 0))", "(12 (0 1 4 0))"), HasSubstr("cells"));
    EXPECT_THAT(reason("(10 (1 1 12 1 3)", "(10 (1 1 7fffffff 1 3)"), HasSubstr("of 18"));
    EXPECT_THAT(reason("4 8 7 6 5 1 4", "4 8 7 6 ff 1 4"), HasSubstr("names node 255"));
    EXPECT_THAT(reason("4 8 7 6 5 1 4", "4 8 7 6 5 1 44"), HasSubstr("names cell 68"));
    EXPECT_THAT(reason("4 8 7 6 5 1 4", "ffffffff 8 7 6 5 1 4"), HasSubstr("bytes are left"));
    EXPECT_THAT(reason("4 8 7 6 5 1 4", "4 8 7 6 -5 1 4"), HasSubstr("expected a number, found '-'"));
    EXPECT_THAT(reason("0 0 0\n", "0,5 0 0\n"), HasSubstr("byte "));
    EXPECT_THAT(reason("(2 3)", "(2 4)"), HasSubstr("dimension is 4"));
    EXPECT_THAT(reason("4 8 7 6 5 1 4", "4 8 7 6 -5 1 4"), HasSubstr("understood so far"));
    // Line ends of another system change nothing.
    std::string windows;
    for (const char c : whole) {
        windows += c == '\n' ? "\r\n" : std::string(1, c);
    }
    EXPECT_EQ(test::cells_of(read_field(alone(folder, windows, "windows.cas"))), 5);
}

TEST(FluentLegacy, DataOfAnotherCaseAreRefused) {
    const core::TemporaryFolder folder;
    const std::string whole = core::read_file(data("ascii.dat"));
    ReadOptions options;
    options.companion = data("ascii.cas");
    const auto reason = [&](const std::string& what, const std::string& by) {
        return test::refusal(alone(folder, replaced(whole, what, by), "other.dat"), options);
    };
    EXPECT_THAT(reason("(33 (5 23 18))", "(33 (5 23 19))"), HasSubstr("belong to another case"));
    EXPECT_THAT(reason("(1 10 1 0 1 5 7)", "(1 77 1 0 1 5 7)"), HasSubstr("zone 77"));
    EXPECT_THAT(reason("(1 10 1 0 1 5 7)", "(1 10 1 0 1 4 6)"), HasSubstr("which has others"));
    EXPECT_THAT(reason("wall zone 10, 3", "velocity-inlet zone 10, 3"), HasSubstr("is of type"));
    EXPECT_THAT(test::refusal(alone(folder, whole, "lonely.dat")), HasSubstr("without a mesh"));
}

TEST(FluentLegacy, ParentsOfAdaptedFacesAndCellsAreHidden) {
    // The same mesh with the cube declared split into a child that has its faces.
    const core::TemporaryFolder folder;
    std::string text = core::read_file(data("ascii.cas"));
    text += "(59 (17 17 c c)(\n1 c\n))\n";
    const auto field = read_field(alone(folder, text, "adapted.cas"));
    EXPECT_EQ(field.find("body")->surface->GetNumberOfCells(), 12);
    EXPECT_EQ(test::cells_of(field), 5);
    text += "(58 (5 5 2 2)(\n1 1\n))\n";
    EXPECT_EQ(test::cells_of(read_field(alone(folder, text, "adapted.cas"))), 4);
}

}  // namespace underbody
