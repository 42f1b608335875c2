// Legacy Fluent files of our own making (tests/data/make_fluent_files.py), whole and damaged.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <cstdio>
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
        for (std::size_t size = 1; size < whole.size(); size += 3) {
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

TEST(FluentLegacy, AWallWithoutPressureTakesThatOfTheCellsBesideIt) {
    std::string text = core::read_file(data("ascii.dat"));
    for (const int zone : {10, 12}) {  // the walls
        const std::size_t begin = text.find("(300 (1 " + std::to_string(zone) + " ");
        ASSERT_NE(begin, std::string::npos);
        text.erase(begin, text.find("))", begin) + 2 - begin);
    }
    const core::TemporaryFolder folder;
    ReadOptions options;
    options.companion = data("ascii.cas");
    for (const bool surfaces_only : {false, true}) {
        options.surfaces_only = surfaces_only;
        const auto field = read_field(alone(folder, text, "cells.dat"), options);
        const auto* floor = field.find("floor");
        ASSERT_NE(floor->find("pressure"), nullptr);
        EXPECT_EQ(floor->find("pressure")->on, postproc::Location::cells);
        EXPECT_EQ(field.find("inlet")->find("pressure")->on, postproc::Location::faces);
        // The cells on the floor are the cube, the pentagonal prism and the wedge.
        const auto whole = read_field(data("ascii.dat"));
        auto* cells = whole.find("water")->volume->GetCellData()->GetArray("pressure");
        const auto range = test::range_of(*floor->surface, "pressure");
        EXPECT_EQ(range.low,
                  std::min({cells->GetComponent(0, 0), cells->GetComponent(1, 0), cells->GetComponent(2, 0)}));
        EXPECT_EQ(range.high,
                  std::max({cells->GetComponent(0, 0), cells->GetComponent(1, 0), cells->GetComponent(2, 0)}));
        const bool told = std::any_of(field.problems.begin(), field.problems.end(), [](const auto& problem) {
            return problem.message.find("that of the cells beside it") != std::string::npos;
        });
        EXPECT_TRUE(told);
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
    EXPECT_THAT(reason("4 8 7 6 5 1 4", "ffffffff 8 7 6 5 1 4"), HasSubstr("more than the bytes of the file can hold"));
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
    EXPECT_EQ(test::cells_of(read_field(alone(folder, "\xEF\xBB\xBF" + whole, "marked.cas"))), 5);
    EXPECT_THAT(reason("0 0 0\n", "0,5 0 0\n"), HasSubstr("decimal comma"));
}

TEST(FluentLegacy, LongBodiesReadByManyThreadsAreRefusedWhereTheyAreWrong) {
    // A strip of 20000 quadrilaterals in 2-D: bodies of several pieces.
    const std::size_t cells = 20000;
    std::string text =
        "(0 \"strip\")\n(2 2)\n(12 (0 1 4e20 0))\n(12 (2 1 4e20 1 3))\n(13 (0 1 ea61 0))\n(10 (0 1 9c42 0 2))\n";
    const auto hex = [](std::size_t value) {
        std::array<char, 20> digits{};
        std::snprintf(digits.data(), digits.size(), "%zx", value);
        return std::string(digits.data());
    };
    std::string inner;
    std::string outer;
    // Nodes: bottom i -> 2 i + 1, top i -> 2 i + 2. An edge has its c0 to the left.
    for (std::size_t i = 0; i <= cells; ++i) {
        const std::string left = hex(i);
        const std::string right = hex(i + 1);
        if (i == 0) {
            outer += "2 1 1 0\n";
        } else if (i == cells) {
            outer += hex(2 * i + 1) + " " + hex(2 * i + 2) + " " + left + " 0\n";
        } else {
            inner += hex(2 * i + 1) + " " + hex(2 * i + 2) + " " + left + " " + right + "\n";
        }
        if (i < cells) {
            outer += hex(2 * i + 1) + " " + hex(2 * i + 3) + " " + right + " 0\n";
            outer += hex(2 * i + 4) + " " + hex(2 * i + 2) + " " + right + " 0\n";
        }
    }
    text += "(13 (3 1 4e1f 2 2)(\n" + inner + "))\n(13 (4 4e20 ea61 3 2)(\n" + outer + "))\n(10 (1 1 9c42 1 2)(\n";
    for (std::size_t i = 0; i <= cells; ++i) {
        text += std::to_string(i) + ".5 0\n" + std::to_string(i) + ".5e0 1\n";
    }
    text += "))\n";
    const core::TemporaryFolder folder;
    const auto field = read_field(alone(folder, text, "strip.cas"));
    EXPECT_EQ(test::cells_of(field), static_cast<long long>(cells));
    EXPECT_NEAR(test::volume_of(field), static_cast<double>(cells), 1e-6);
    EXPECT_EQ(field.find("wall-4")->surface->GetNumberOfCells(), static_cast<vtkIdType>(2 * cells + 2));
    const auto wrong = [&](const std::string& what, const std::string& by) {
        return test::refusal(alone(folder, replaced(text, what, by), "wrong.cas"));
    };
    const std::size_t face = text.find("2711 2712 1388 1389");
    ASSERT_NE(face, std::string::npos);
    EXPECT_THAT(wrong("2711 2712 1388 1389", "2711 2712 1388 x389"), HasSubstr("byte " + std::to_string(face + 15)));
    EXPECT_THAT(wrong("2711 2712 1388 1389", "2711 2712 1388"), HasSubstr("ends before all"));
    EXPECT_THAT(wrong("2711 2712 1388 1389", "2711 2712 1388 1389 7"), HasSubstr("more than its header says"));
    EXPECT_THAT(wrong("2711 2712 1388 1389", "2711 2712 1388 1389a1389"), HasSubstr("too large"));
    const std::size_t node = text.find("15000.5 0\n");
    EXPECT_THAT(wrong("15000.5 0\n", "15000.5 0,0\n"), HasSubstr("byte " + std::to_string(node + 9)));
    EXPECT_THAT(wrong("15000.5 0\n", "15000.5\n"), HasSubstr("expected a number, found ')'"));
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

TEST(FluentLegacy, ACommentSpeaksOfTheSectionBehindItAlone) {
    const core::TemporaryFolder folder;
    ReadOptions options;
    options.companion = data("ascii.cas");
    const std::string whole = core::read_file(data("ascii.dat"));
    const std::string temperature = "(300 (3 10 1 0 1 5 7)(300 301 302))\n";
    const auto range = [&](const std::string& text, const char* array) {
        const auto field = read_field(alone(folder, text, "more.dat"), options);
        return test::range_of(*field.find("floor")->surface, array);
    };
    EXPECT_EQ(range(whole + temperature, "temperature").high, 302);
    EXPECT_LT(range(whole + temperature, "pressure").high, 100);
    // Nor does one that speaks of another zone.
    EXPECT_EQ(range(whole + "(0 \"SV_P, domain 1, cell zone 2, 5 cells:\")\n" + temperature, "temperature").low, 300);
    const auto twice = read_field(alone(folder, whole + temperature + temperature, "twice.dat"), options);
    EXPECT_TRUE(std::any_of(twice.problems.begin(), twice.problems.end(), [](const auto& p) {
        return p.message == "SV_T on zone 10 stands twice in the data: the first counts";
    }));
}

TEST(FluentLegacy, AZoneInSeveralSectionsTakesItsValuesFromOne) {
    const core::TemporaryFolder folder;
    const std::string text = replaced(core::read_file(data("ascii.cas")), "(13 (a 5 7 3 0)\n(\n4 1 2 3 4 1 0\n",
                                      "(13 (a 5 5 3 0)\n(\n4 1 2 3 4 1 0\n))\n(13 (a 6 7 3 0)\n(\n");
    ReadOptions options;
    options.companion = data("ascii.dat");
    const auto whole = read_field(data("ascii.cas"), options);
    const auto cut = read_field(alone(folder, text, "cut.cas"), options);
    EXPECT_EQ(cut.find("floor")->surface->GetNumberOfCells(), 3);
    EXPECT_EQ(test::pressure_force(*cut.find("floor")->surface), test::pressure_force(*whole.find("floor")->surface));
    EXPECT_EQ(test::viscous_force(*cut.find("floor")->surface), test::viscous_force(*whole.find("floor")->surface));
}

TEST(FluentLegacy, AFaceOfTwoCornersIsNoFace) {
    const core::TemporaryFolder folder;
    const auto field = read_field(alone(
        folder, replaced(core::read_file(data("ascii.cas")), "4 1 2 3 4 1 0\n5 2", "2 1 2 1 0\n5 2"), "thin.cas"));
    EXPECT_TRUE(std::any_of(field.problems.begin(), field.problems.end(), [](const auto& p) {
        return p.severity == core::Problem::Severity::error &&
               p.message.find("1 face of zone 'floor' has fewer corners") == 0;
    }));
}

TEST(FluentLegacy, AWallBesideSolidsAloneIsNoWallOfTheFluid) {
    const core::TemporaryFolder folder;
    const std::string text =
        replaced(core::read_file(data("ascii.cas")), "(39 (2 fluid water 1)", "(39 (2 solid hull-metal 1)");
    const auto field = read_field(alone(folder, text, "metal.cas"));
    EXPECT_EQ(field.find("body")->kind, postproc::ZoneKind::solid);
    EXPECT_TRUE(std::any_of(field.problems.begin(), field.problems.end(), [](const auto& p) {
        return p.message == "wall 'body' bounds solids alone: no fluid acts on it";
    }));
    EXPECT_EQ(read_field(data("ascii.cas")).find("body")->kind, postproc::ZoneKind::wall);
}

TEST(FluentLegacy, TheRunKnowsItsOwnTime) {
    const core::TemporaryFolder folder;
    std::string text = core::read_file(data("ascii.cas"));
    text += "(37 (\n(flow-time 0)\n))\n";
    ReadOptions options;
    options.companion = data("ascii.dat");
    const auto field = read_field(alone(folder, text, "begun.cas"), options);
    EXPECT_THAT(field.metadata, ::testing::Contains(std::pair<std::string, std::string>("flow-time", "1.5")));
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
