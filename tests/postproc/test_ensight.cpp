// EnSight Gold files of our own making (tests/data/make_ensight_files.py), whole and damaged.
#include <gmock/gmock.h>
#include <vtkCellType.h>
#include <vtkPointData.h>

#include <fstream>

#include "core/file.h"
#include "import_support.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using ::testing::HasSubstr;

namespace {

constexpr double whole_volume = 1 + 1.25 + 0.5 + 1.0 / 3 + 0.25;

std::filesystem::path data(const std::string& name) { return test::data_folder() / "ensight" / name; }

}  // namespace

TEST(Ensight, EveryCodingAndByteOrderGivesTheSameCells) {
    for (const char* name : {"little.encas", "big.encas", "fortran.encas", "ascii.encas"}) {
        SCOPED_TRACE(name);
        const auto field = read_field(data(name));
        const auto* water = field.find("water");
        ASSERT_NE(water, nullptr);
        for (const int type : {VTK_HEXAHEDRON, VTK_POLYHEDRON, VTK_WEDGE, VTK_PYRAMID, VTK_TETRA}) {
            EXPECT_EQ(test::count_cells(*water->volume, type), 1) << type;
        }
        EXPECT_NEAR(test::volume_of(*water->volume), whole_volume, 1e-5);
        EXPECT_NEAR(test::smallest_volume(*water->volume), 0.25, 1e-5);
        auto* pressure = water->volume->GetPointData()->GetArray("pressure");
        ASSERT_NE(pressure, nullptr);
        EXPECT_NEAR(pressure->GetTuple1(17), 1 + 2 * 2 + 3 * 0.5 + 4 * 2, 1e-5);
        const auto* body = field.find("body");
        ASSERT_NE(body, nullptr);
        EXPECT_EQ(body->surface->GetNumberOfCells(), 13);
        EXPECT_NEAR(test::viscous_force(*body->surface)[0], 0.5 * test::area_of(*body->surface), 1e-5);
    }
}

TEST(Ensight, AGeometryOrVariableCutAnywhereIsRefused) {
    for (const char* stem : {"little", "fortran", "ascii"}) {
        const core::TemporaryFolder folder;
        for (const char* ending : {".encas", ".geo", ".scl1", ".vel"}) {
            std::filesystem::copy_file(data(std::string(stem) + ending), folder.path() / (std::string(stem) + ending));
        }
        for (const char* ending : {".geo", ".scl1"}) {
            const auto target = folder.path() / (std::string(stem) + ending);
            const std::string whole = core::read_file(target);
            for (std::size_t size = 0; size + 1 < whole.size(); size += 17) {
                std::ofstream(target, std::ios::binary) << whole.substr(0, size);
                try {
                    const auto field = read_field(folder.path() / (std::string(stem) + ".encas"));
                    // Cut between two parts or kinds of elements: told.
                    bool told = false;
                    for (const auto& problem : field.problems) {
                        told = told || problem.message.find("cut short") != std::string::npos;
                    }
                    EXPECT_TRUE(told) << stem << ending << " at " << size;
                } catch (const core::InputError& error) {
                    EXPECT_THAT(error.what(), HasSubstr(stem));
                }
            }
            std::ofstream(target, std::ios::binary) << whole;
        }
    }
}

TEST(Ensight, LinesOfACaseMayHaveAnySpacingAndWhatIsNotKnownIsTold) {
    const core::TemporaryFolder folder;
    for (const char* ending : {".geo", ".scl1", ".vel"}) {
        std::filesystem::copy_file(data(std::string("ascii") + ending),
                                   folder.path() / (std::string("ascii") + ending));
    }
    const auto path = folder.path() / "case.encas";
    const auto with = [&](const std::string& variable) {
        core::write_file(path,
                         "# a comment\nFORMAT\ntype:ensight gold\nGeometry\n model:ascii.geo\nVARIABLE\n" + variable);
        return read_field(path);
    };
    const auto spaced = with("Scalar \t per  node :  Static_Pressure   ascii.scl1 \r\n");
    EXPECT_NE(spaced.find("body")->find("pressure"), nullptr);
    EXPECT_EQ(test::told(spaced).find("passed over"), std::string::npos);
    const auto unknown = with("scaler per node: Static_Pressure ascii.scl1\n");
    EXPECT_EQ(unknown.find("body")->find("pressure"), nullptr);
    ASSERT_FALSE(unknown.problems.empty());
    EXPECT_EQ(unknown.problems.front().message,
              "'scaler per node' is not known under VARIABLE and passed over; did you mean 'scalar per node'?");
    EXPECT_EQ(unknown.problems.front().place.line, 7);
    EXPECT_EQ(unknown.problems.front().severity, core::Problem::Severity::warning);
}

TEST(Ensight, AMissingGeometryIsSaid) {
    const core::TemporaryFolder folder;
    std::filesystem::copy_file(data("little.encas"), folder.path() / "little.encas");
    EXPECT_THAT(test::refusal(folder.path() / "little.encas"), HasSubstr("little.geo' of this case is not there"));
}

}  // namespace underbody
