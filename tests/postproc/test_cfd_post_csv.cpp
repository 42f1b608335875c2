#include <gmock/gmock.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/file.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/field/field.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

using testing::HasSubstr;

/// Two triangles; the second block is a quad.
const std::string good =
    "\n[Name]\nbase\n\n[Data]\n"
    "X [ m ], Y [ m ], Z [ m ], Pressure [ Pa ], Wall Shear X [ Pa ], Wall Shear Y [ Pa ], Wall Shear Z [ Pa ]\n"
    "0,0,0, 1.5e+01, 1,0,0\n"
    "1,0,0, 2.5e+01, 1,0,0\n"
    "1,1,0, -3.5e+01, 1,0,2\n"
    "0,1,0, 4.5E+001, 1,0,0\n"
    "\n[Faces]\n0, 1, 2\n0, 2, 3\n"
    "\n[Name]\nhull\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]\n"
    "0,0,1,1\n1,0,1,2\n1,1,1,3\n0,1,1,4\n\n[Faces]\n0,1,2,3\n";

Field read_text(const std::string& text, const ReadOptions& options = {}) {
    const core::TemporaryFolder folder;
    std::ofstream(folder.path() / "field.csv", std::ios::binary) << text;  // thousands of them: not synced to the disk
    return read_field(folder.path() / "field.csv", options);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

/// Reads a damaged text; returns "line N: message" of the error.
std::string failure(const std::string& text, const ReadOptions& options = {}) {
    try {
        read_text(text, options);
    } catch (const core::InputError& error) {
        return "line " + std::to_string(error.place().line.value_or(0)) + ": " + error.message() + " | " + error.hint();
    }
    return "read without an error";
}

double value(const Zone& zone, const char* array, vtkIdType i, int component = 0) {
    return zone.surface->GetPointData()->GetArray(array)->GetComponent(i, component);
}

TEST(CfdPostCsv, ReadsBlocksWithFacesAndJoinsComponents) {
    const Field field = read_text(good);
    EXPECT_EQ(field.format, "CFD-Post CSV");
    ASSERT_EQ(field.zones.size(), 2U);
    const Zone& base = *field.find("base");
    EXPECT_EQ(base.surface->GetNumberOfPoints(), 4);
    EXPECT_EQ(base.surface->GetNumberOfPolys(), 2);
    EXPECT_EQ(value(base, "pressure", 2), -35);
    EXPECT_EQ(value(base, "pressure", 3), 45);
    EXPECT_EQ(base.surface->GetPointData()->GetArray("wall_shear")->GetNumberOfComponents(), 3);
    EXPECT_EQ(value(base, "wall_shear", 2, 2), 2);
    EXPECT_EQ(base.find("pressure")->unit, "Pa");
    EXPECT_EQ(base.find("pressure")->original_name, "Pressure");
    EXPECT_FALSE(base.normals_into_fluid);
    EXPECT_EQ(field.find("hull")->surface->GetNumberOfPolys(), 1);
    EXPECT_TRUE(field.problems.empty()) << field.problems.front().message;
}

TEST(CfdPostCsv, DoesNotCareForBomLineEndsCommentsAndSpreadsheetCommas) {
    std::string text = "\xEF\xBB\xBF" + good.substr(1);
    text = replaced(text, "0,0,0, 1.5e+01", "# a remark, with commas and [brackets]\n0,0,0, 1.5e+01");
    text = replaced(text, "[Faces]\n", "[Faces],,,,\n\n");
    text = replaced(text, "0, 1, 2\n", "0, 1, 2,,,\n,,,,,\n");
    std::string crlf;
    for (const char c : text) {
        crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    }
    const Field field = read_text(crlf);
    EXPECT_EQ(field.zones.size(), 2U);
    EXPECT_EQ(value(field.zones[0], "pressure", 3), 45);
    EXPECT_EQ(field.zones[0].surface->GetNumberOfPolys(), 2);
}

TEST(CfdPostCsv, ConvertsTheUnitsOfTheHeader) {
    std::string text =
        replaced(good, "X [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]", "X [ mm ], Y [mm], Z [ mm ], Pressure [ bar ]");
    text =
        replaced(text, "X [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]", "X [ m ], Y [ mm ], Z [ m ], Temperature [ C ]");
    const Field field = read_text(text);
    EXPECT_NEAR(field.zones[0].surface->GetPoint(1)[0], 0.001, 1e-18);
    EXPECT_NEAR(value(field.zones[0], "pressure", 0), 15e5, 1e-6);
    EXPECT_NEAR(value(field.zones[1], "temperature", 1), 275.15, 1e-9);
    ASSERT_EQ(field.problems.size(), 1U);  // mixed units are said
    EXPECT_THAT(field.problems[0].message, HasSubstr("different units"));
    EXPECT_NEAR(value(read_text(replaced(good, "Pressure [ Pa ]", "Pressure [ psf ]")).zones[0], "pressure", 0),
                15 * 47.88025898, 1e-6);
}

TEST(CfdPostCsv, AsksForUnitsThatTheFileDoesNotSay) {
    const std::string no_length = replaced(good, "X [ m ], Y", "X, Y");
    EXPECT_THAT(failure(no_length), HasSubstr("line 6: coordinate 'X' has no unit | say it: option 'length-unit"));
    ReadOptions options;
    options.length_unit = "m";
    EXPECT_EQ(read_text(no_length, options).zones.size(), 2U);
    const std::string no_pressure = replaced(good, "Pressure [ Pa ]", "Pressure");
    EXPECT_THAT(failure(no_pressure), HasSubstr("line 6: column 'Pressure' has no unit"));
    options.units = {{"Pressure", "kPa"}};
    EXPECT_NEAR(value(read_text(no_pressure, options).zones[0], "pressure", 0), 15000, 1e-9);
    EXPECT_THAT(failure(replaced(good, "Pressure [ Pa ]", "Pressure [ m ]")), HasSubstr("another dimension"));
    EXPECT_THAT(failure(replaced(good, "X [ m ]", "X [ furlongish ]")), HasSubstr("unknown unit 'furlongish'"));
}

TEST(CfdPostCsv, NamesFileAndLineOfWhatIsWrong) {
    const std::vector<std::pair<std::string, std::string>> cases = {
        {replaced(good, "1,1,0, -3.5e+01", "1,1,0, -3.5x+01"), "line 9: 'x+01' behind a number"},
        {replaced(good, "1,1,0, -3.5e+01", "1,1,0, abc"), "line 9: 'abc' is not a number"},
        {replaced(good, "1,1,0, -3.5e+01", "1,1,0, nan"), "line 9: 'nan' is not a finite number"},
        {replaced(good, "1,1,0, -3.5e+01", "1,1,0, -inf"), "line 9: '-inf' is not a finite number"},
        {replaced(good, "1,1,0, -3.5e+01", "1,1,0, 1e999"), "line 9: '1e999' is not a number"},
        {replaced(good, "1,1,0, -3.5e+01, 1,0,2", "1,1,0, -3.5e+01, 1"),
         "line 9: the row has 5 values, the header names 7"},
        {replaced(good, "1,1,0, -3.5e+01, 1,0,2", "1,1,0, -3.5e+01, 1,0,2,7"), "line 9: the row has more values"},
        {replaced(good, "0, 2, 3\n", "0, 2, 4\n"), "line 14: node 4 is missing: zone 'base' has 4 nodes"},
        {replaced(good, "0, 2, 3\n", "0, -2, 3\n"), "line 14: '-2' is not a node number"},
        {replaced(good, "0, 2, 3\n", "0, 2\n"), "line 14: a row of 2 node numbers"},
        {replaced(good, "0, 2, 3\n", "0, 2 3\n"), "line 14: '3' behind a node number"},
        {replaced(good, "hull", "base"), "line 16: two zones are called 'base'"},
        {replaced(good, "1,1,0, -3.5e+01", ",1,0, -3.5e+01"), "line 9: coordinate 'X' has no value here"},
        {replaced(good,
                  "\n0,0,0, 1.5e+01, 1,0,0\n1,0,0, 2.5e+01, 1,0,0\n1,1,0, -3.5e+01, 1,0,2\n0,1,0, 4.5E+001, 1,0,0\n",
                  "\n"),
         "has no rows"},
        {"[Name]\nempty\n", "line 1: zone 'empty' has no [Data]"},
        {"[Name]\nx\n[Data]\n", "line 3: [Data] of zone 'x' is empty"},
        {"[Name]\n[Data]\nX [m],Y [m]\n1,2\n", "line 1: [Name] without a name"}};
    for (const auto& [text, expected] : cases) {
        EXPECT_THAT(failure(text), HasSubstr(expected));
    }
}

TEST(CfdPostCsv, NeverTakesATruncatedFileForAWholeOne) {
    // Cut anywhere behind the first block's name, the file is refused, or what is missing is said.
    int silent = 0;
    for (std::size_t size = 10; size + 1 < good.size(); ++size) {
        try {
            const Field field = read_text(good.substr(0, size));
            const bool whole = field.zones.size() == 2 && field.zones[1].surface->GetNumberOfPolys() == 1;
            silent += field.problems.empty() && !whole && good[size - 1] != '\n' ? 1 : 0;
        } catch (const core::InputError& error) {
            EXPECT_FALSE(error.place().file.empty());
        }
    }
    EXPECT_EQ(silent, 0);
}

TEST(CfdPostCsv, SeesThatANodeOfTheLastFaceLostADigit) {
    const core::TemporaryFolder folder;
    std::string text = "[Name]\nprism\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]\n";
    for (int i = 0; i < 12; ++i) {
        const double angle = M_PI / 3 * (i % 6);
        text += std::to_string(std::cos(angle)) + ", " + std::to_string(std::sin(angle)) + ", " +
                std::to_string(i / 6) + ", 1\n";
    }
    text += "\n[Faces]\n0, 5, 4, 3, 2, 1\n6, 7, 8, 9, 10, 11\n";
    for (int i = 0; i < 6; ++i) {
        text += std::to_string(i) + ", " + std::to_string((i + 1) % 6) + ", " + std::to_string((i + 1) % 6 + 6) + ", " +
                std::to_string(i + 6) + "\n";
    }
    const auto errors = [&](std::size_t missing) {
        core::write_file(folder.path() / "prism.csv", text.substr(0, text.size() - missing));
        const auto field = postproc::read_field(folder.path() / "prism.csv");
        return std::count_if(field.problems.begin(), field.problems.end(),
                             [](const auto& p) { return p.severity == core::Problem::Severity::error; });
    };
    EXPECT_EQ(errors(0), 0);
    EXPECT_EQ(errors(1), 0);  // the last line end alone
    EXPECT_EQ(errors(2), 1);  // 5, 0, 6, 1
    EXPECT_EQ(errors(3), 1);  // 5, 0, 6,
    EXPECT_EQ(errors(5), 1);  // 5, 0, 6
}

TEST(CfdPostCsv, TellsDecimalCommasAndTakesSemicolonsWithPoints) {
    std::string semicolons =
        "[Name]\na\n[Data]\nX [ m ];Y [ m ];Z [ m ];Pressure [ Pa ]\n0;0;0;1.5\n1;0;0;2.5\n0;1;0;3.5\n[Faces]\n0;1;2\n";
    EXPECT_EQ(value(read_text(semicolons).zones[0], "pressure", 1), 2.5);
    EXPECT_THAT(failure(replaced(semicolons, "1.5", "1,5")), HasSubstr("line 5: '1,5' has a decimal comma"));
}

TEST(CfdPostCsv, TakesTabsBetweenColumns) {
    std::string tabs = good;
    std::replace(tabs.begin(), tabs.end(), ',', '\t');
    const Field field = read_text(tabs);
    EXPECT_EQ(value(field.zones[0], "pressure", 2), -35);
    EXPECT_EQ(value(field.zones[0], "wall_shear", 2, 2), 2);
    EXPECT_EQ(field.zones[1].surface->GetNumberOfPolys(), 1);
    EXPECT_THAT(failure(replaced(tabs, "0\t1\t1\t4", "0\t1\t\t4")), HasSubstr("coordinate 'Z' has no value"));
}

TEST(CfdPostCsv, KeepsMissingValuesAsMissingAndSaysWhere) {
    const Field field =
        read_text(replaced(replaced(good, "1,1,0, -3.5e+01", "1,1,0, null"), "0,1,0, 4.5E+001", "0,1,0, "));
    EXPECT_TRUE(std::isnan(value(field.zones[0], "pressure", 2)));
    EXPECT_TRUE(std::isnan(value(field.zones[0], "pressure", 3)));
    ASSERT_EQ(field.problems.size(), 1U);
    EXPECT_EQ(*field.problems[0].place.line, 9);
    EXPECT_THAT(field.problems[0].message, HasSubstr("2 of 4 values of 'Pressure' are missing"));
}

TEST(CfdPostCsv, TakesRepeatedColumnsOnceAndNodeNumbersAsNumbers) {
    const Field field = read_text(
        "[Name]\na\n[Data]\nNode Number, X [ m ], Y [ m ], Z [ m ], Pressure [ Pa ], Pressure [ Pa ], X [ m ], "
        "Velocity [ m s^-1 ], Velocity u [ m s^-1 ]\n"
        "0,0,0,0,1,1,0,3,1\n1,1,0,0,2,2,1,3,1\n2,0,1,0,3,3,0,3,1\n[Faces]\n0,1,2\n");
    const auto& arrays = field.zones[0].arrays;
    ASSERT_EQ(arrays.size(), 3U);
    EXPECT_EQ(arrays[0].name, "pressure");
    EXPECT_EQ(arrays[1].name, "velocity_magnitude");
    EXPECT_EQ(arrays[2].name, "velocity_x");
}

TEST(CfdPostCsv, ReadsLinesPointsAndProfilesWithoutCoordinates) {
    const Field line = read_text(
        "[Name]\ncut\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa "
        "]\n0,0,0,1\n1,0,0,2\n2,0,0,3\n[Lines]\n0,1\n1,2\n");
    EXPECT_EQ(line.zones[0].kind, ZoneKind::line);
    EXPECT_EQ(line.zones[0].surface->GetNumberOfLines(), 2);
    const Field profile = read_text(
        "[Name],,\nInflow,,\n\n[Spatial Fields],,\nr,,\n\n[Data],,\nr [ m ], Total Pressure [ Pa ], Velocity "
        "Axial\n0.2,1e5,1\n0.3,1.1e5,1\n");
    EXPECT_EQ(profile.zones[0].kind, ZoneKind::other);
    EXPECT_EQ(profile.zones[0].surface->GetFieldData()->GetArray("pressure_total")->GetComponent(1, 0), 1.1e5);
}

TEST(CfdPostCsv, KeepsACylindricalProfileAsATableWithItsCoordinates) {
    const Field profile = read_text(
        "[Name]\nInflow\n[Spatial Fields]\nr,Theta,z\n[Data]\nr [ mm ], Theta [ degree ], z [ m ], Pressure [ Pa ], "
        "Velocity r [ m s^-1 ]\n"
        "200,0,0.5,1,3\n200,90,0.5,2,4\n");
    const auto& zone = profile.zones[0];
    EXPECT_EQ(zone.kind, ZoneKind::other);  // nobody knows where its axis lies: no surface is made of it
    EXPECT_EQ(zone.original_kind, "profile without coordinates");
    auto* data = zone.surface->GetFieldData();
    ASSERT_NE(data->GetArray("r"), nullptr);
    EXPECT_NEAR(data->GetArray("r")->GetComponent(1, 0), 0.2, 1e-15);
    ASSERT_NE(data->GetArray("Theta"), nullptr);
    EXPECT_NEAR(data->GetArray("Theta")->GetComponent(1, 0), M_PI / 2, 1e-12);
    ASSERT_NE(data->GetArray("z"), nullptr);
    EXPECT_EQ(data->GetArray("z")->GetComponent(0, 0), 0.5);
    EXPECT_EQ(data->GetArray("pressure")->GetComponent(1, 0), 2);
    EXPECT_EQ(data->GetArray("Velocity r")->GetComponent(0, 0), 3);
}

TEST(CfdPostCsv, FindsFacesThatRunOppositeWaysAndFacesWithoutArea) {
    const Field turned = read_text(replaced(good, "0, 2, 3\n", "3, 2, 0\n"));
    ASSERT_FALSE(turned.problems.empty());
    EXPECT_THAT(turned.problems[0].message, HasSubstr("1 were turned to agree"));
    vtkNew<vtkIdList> ids;
    turned.zones[0].surface->GetCellPoints(1, ids);
    EXPECT_EQ(ids->GetId(0), 0);
    const Field flat = read_text(replaced(good, "0, 2, 3\n", "0, 2, 3\n0, 2, 2\n"));
    const auto& problem = flat.problems.front();
    EXPECT_EQ(problem.severity, core::Problem::Severity::error);
    EXPECT_THAT(problem.message, HasSubstr("no area"));
    EXPECT_EQ(*problem.place.line, 15);
}

TEST(CfdPostCsv, ReadsEveryNumberExactlyAndTheSameWithAnyNumberOfThreads) {
    core::Random random(11);
    std::string text = "[Name]\na\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ], q\n";
    std::vector<double> expected;
    for (int i = 0; i < 60000; ++i) {  // several chunks of 2 MiB
        const double p = random.normal() * std::pow(10.0, std::floor(random.uniform(-30, 30)));
        char odd[64];
        std::snprintf(odd, sizeof odd, i % 3 == 0 ? "%.9e" : i % 3 == 1 ? "%.17g" : "%.6f", random.normal() * 1e3);
        expected.push_back(p);
        expected.push_back(*core::parse_number(odd));
        text += std::to_string(i) + ",0,1, " + core::format_number(p) + " , " + odd + (i % 1000 == 0 ? "\n\n" : "\n");
    }
    for (const int threads : {1, 2, 4}) {
        core::set_threads(threads);
        const Field field = read_text(text);
        ASSERT_EQ(field.zones[0].surface->GetNumberOfPoints(), 60000);
        for (vtkIdType i = 0; i < 60000; ++i) {
            ASSERT_EQ(value(field.zones[0], "pressure", i), expected[static_cast<std::size_t>(2 * i)]);
            ASSERT_EQ(value(field.zones[0], "q", i), expected[static_cast<std::size_t>(2 * i + 1)]);
            ASSERT_EQ(field.zones[0].surface->GetPoint(i)[0], static_cast<double>(i));
        }
    }
    core::set_threads(0);
}

TEST(CfdPostCsv, TakesOnlyTheZonesAndArraysAskedFor) {
    ReadOptions options;
    options.zones = {"h*"};
    options.arrays = {"pressure"};
    const Field field = read_text(good, options);
    ASSERT_EQ(field.zones.size(), 1U);
    EXPECT_EQ(field.zones[0].name, "hull");
    options.zones = {"keel"};
    EXPECT_THAT(failure(good, options), HasSubstr("no zone of the file fits"));
}

TEST(CfdPostCsv, TakesAsLongForABlockWhereverItStands) {
    // Lines were once counted from the start of the file for every column: a minute and more for these 14 MB.
    std::string text;
    for (int block = 0; block < 4000; ++block) {
        text += "[Name]\nb" + std::to_string(block) + "\n[Data]\nX [ m ], Y [ m ], Z [ m ]";
        for (int c = 0; c < 12; ++c) {
            text += ", Var" + std::to_string(c) + " [ Pa ]";
        }
        for (int row = 0; row < 100; ++row) {
            text += "\n0,0," + std::to_string(row) + ",1,1,1,1,1,1,1,1,1,1,1,1";
        }
        text += "\n\n";
    }
    const double begin = test::processor_seconds();
    EXPECT_EQ(read_text(text).zones.size(), 4000U);
    EXPECT_LT(test::processor_seconds() - begin, 20);
}

TEST(CfdPostCsv, RefusesNodeNumbersThatNoNumberHolds) {
    EXPECT_THAT(failure(replaced(good, "0, 2, 3\n", "0, 2, " + std::string(40, '9') + "\n")),
                HasSubstr("is not a node number"));
}

/// A tetrahedron with columns of `header` behind its coordinates, the same `values` in every row.
std::string body(const std::string& header, const std::string& values, const std::string& name = "body") {
    std::string text = "[Name]\n" + name + "\n[Data]\nX [ m ],Y [ m ],Z [ m ]," + header + "\n";
    for (const char* at : {"0,0,0,", "1,0,0,", "0,1,0,", "0,0,1,"}) {
        text += at + values + "\n";
    }
    return text + "\n[Faces]\n0,2,1\n0,1,3\n1,2,3\n0,3,2\n\n";
}

std::vector<std::string> names_in(const Zone& zone) {
    std::vector<std::string> names;
    for (const auto& info : zone.arrays) {
        names.push_back(info.name);
    }
    return names;
}

std::string words_of(const Field& field) {
    std::string text;
    for (const auto& problem : field.problems) {
        text += problem.message + "\n";
    }
    return text;
}

TEST(CfdPostCsv, OneComponentAskedForIsThatComponent) {
    const std::string text =
        body("Pressure [ Pa ],Velocity u [ m s^-1 ],Velocity v [ m s^-1 ],Velocity w [ m s^-1 ]", "7,1,2,3");
    ReadOptions options;
    for (const char* name : {"Velocity v", "velocity_y", "*_y"}) {
        options.arrays = {name};
        const Field field = read_text(text, options);
        EXPECT_THAT(names_in(field.zones[0]), testing::ElementsAre("velocity_y")) << name;
        EXPECT_EQ(value(field.zones[0], "velocity_y", 3), 2);
        EXPECT_THAT(field.problems, testing::IsEmpty());
    }
    for (const char* name : {"velocity", "Velocity*", "vel*y"}) {
        options.arrays = {name};
        const Field field = read_text(text, options);
        EXPECT_THAT(names_in(field.zones[0]), testing::ElementsAre("velocity")) << name;
        EXPECT_EQ(value(field.zones[0], "velocity", 3, 2), 3);
        EXPECT_EQ(field.zones[0].arrays[0].original_name, "Velocity u, Velocity v, Velocity w");
    }
}

TEST(CfdPostCsv, AMissingComponentIsNoughtInAPlaneCaseOnly) {
    const Field solid = read_text(body("Velocity u [ m s^-1 ],Velocity v [ m s^-1 ]", "1,2"));
    EXPECT_THAT(names_in(solid.zones[0]), testing::ElementsAre("velocity_x", "velocity_y"));
    EXPECT_THAT(words_of(solid), HasSubstr("velocity has no z component here: no vector, but velocity_x, velocity_y"));
    const Field plane = read_text(
        "[Name]\ncut\n[Data]\nX [ m ],Y [ m ],Velocity u [ m s^-1 ],Velocity v [ m s^-1 ]\n0,0,1,2\n1,0,1,2\n");
    EXPECT_EQ(plane.dimension, 2);
    EXPECT_EQ(value(plane.zones[0], "velocity", 1, 1), 2);
    EXPECT_EQ(value(plane.zones[0], "velocity", 1, 2), 0);
}

TEST(CfdPostCsv, OfColumnsOfOneMeaningThePlainestCounts) {
    for (const char* header : {"Static Pressure [ Pa ],pressure [ kPa ]", "Solved Pressure [ Pa ],Pressure [ kPa ]"}) {
        const Field field = read_text(body(header, "5,7"));
        const Zone& zone = field.zones[0];
        ASSERT_EQ(zone.arrays.size(), 2U);
        EXPECT_EQ(value(zone, "pressure", 0), 7000) << header;
        EXPECT_EQ(value(zone, zone.arrays[0].name.c_str(), 0), 5);
        EXPECT_EQ(zone.arrays[0].name, zone.arrays[0].original_name);
        EXPECT_THAT(words_of(field), HasSubstr("both mean pressure"));
    }
    // The name of the other may be taken too.
    const Field field = read_text(body("P [ Pa ],Static Pressure [ Pa ],pressure [ Pa ],P (2)", "1,2,3,4"));
    EXPECT_THAT(names_in(field.zones[0]), testing::ElementsAre("P", "Static Pressure", "pressure", "P (2)"));
}

TEST(CfdPostCsv, LettersForTemperaturesBesideOtherUnitsAreDifferences) {
    const Field field =
        read_text(body("h [ Btu hr^-1 ft^-2 F^-1 ],Grad T [ C m^-1 ],Expansion [ C^-1 ],Old [ Btu lb^-1 R^-1 "
                       "],Reference [ F ],Temperature [ C ]",
                       "1,1,1,1,32,20"));
    const Zone& zone = field.zones[0];
    EXPECT_NEAR(value(zone, "h", 0), 5.678263, 1e-6);
    EXPECT_EQ(value(zone, "Grad T", 0), 1);
    EXPECT_TRUE(core::same_dimension(zone.find("Grad T")->unit, "K/m")) << zone.find("Grad T")->unit;
    EXPECT_TRUE(core::same_dimension(zone.find("h")->unit, "W m^-2 K^-1")) << zone.find("h")->unit;
    EXPECT_TRUE(core::same_dimension(zone.find("Expansion")->unit, "1/K")) << zone.find("Expansion")->unit;
    EXPECT_NEAR(value(zone, "Old", 0), 4186.8, 0.1);
    EXPECT_NEAR(value(zone, "Reference", 0), 273.15, 1e-9);
    EXPECT_NEAR(value(zone, "temperature", 0), 293.15, 1e-9);
}

TEST(CfdPostCsv, AnOddUnitRefusesTheFileOnlyWhereItCounts) {
    const Field field = read_text(body("Pressure [ Pa ],T [ s ],density [ m ],Enthalpy [ furlongish ]", "1,2,3,4"));
    EXPECT_THAT(names_in(field.zones[0]), testing::ElementsAre("pressure", "T", "density [m]", "Enthalpy"));
    EXPECT_EQ(field.zones[0].find("T")->unit, "s");
    EXPECT_THAT(words_of(field), HasSubstr("column 'T' is in s, which no temperature is"));
    EXPECT_THAT(words_of(field), HasSubstr("unit 'furlongish' of column 'Enthalpy' is not known"));
    EXPECT_THAT(failure(body("Pressure [ s ]", "1")), HasSubstr("another dimension"));
    EXPECT_THAT(failure(body("Wall Shear X [ m ]", "1")), HasSubstr("another dimension"));
    EXPECT_THAT(failure(body("Pressure [ furlongish ]", "1")), HasSubstr("unknown unit"));
    EXPECT_THAT(failure(replaced(body("Pressure [ Pa ]", "1"), "Z [ m ]", "Z [ Pa ]")), HasSubstr("another dimension"));
}

TEST(CfdPostCsv, ABlockWithoutZMakesNoPlaneCaseOfABody) {
    const std::string cut = "[Name]\ncut\n[Data]\nX [ m ],Y [ m ],Pressure [ Pa ]\n0,0,1\n1,0,1\n\n";
    EXPECT_EQ(read_text(cut).dimension, 2);
    for (const std::string& text : {cut + body("Pressure [ Pa ]", "1"), body("Pressure [ Pa ]", "1") + cut}) {
        const Field field = read_text(text);
        EXPECT_EQ(field.dimension, 3);
        EXPECT_THAT(words_of(field), HasSubstr("cut has no column Z beside zones that have one"));
    }
}

TEST(CfdPostCsv, AUnitStatedAgainstTheFileIsTakenAndTold) {
    ReadOptions options;
    options.units = {{"Pressure", "kPa"}};
    const Field field = read_text(body("Pressure [ Pa ]", "2"), options);
    EXPECT_EQ(value(field.zones[0], "pressure", 0), 2000);
    EXPECT_THAT(words_of(field), HasSubstr("the file has 'Pressure' in Pa; kPa is taken"));
    options.units = {{"Pressure", "N/m^2"}};
    EXPECT_THAT(read_text(body("Pressure [ Pa ]", "2"), options).problems, testing::IsEmpty());
    options.units.clear();
    options.length_unit = "mm";
    EXPECT_THAT(words_of(read_text(body("Pressure [ Pa ]", "2"), options)), HasSubstr("coordinate 'X' is in m"));
}

TEST(CfdPostCsv, PressureOverDensityIsKinematic) {
    const Field field = read_text(body("Pressure [ m^2 s^-2 ]", "2"));
    EXPECT_THAT(names_in(field.zones[0]), testing::ElementsAre("kinematic_pressure"));
}

TEST(CfdPostCsv, SaysOnceWhatAllBlocksHaveAlike) {
    std::string text;
    for (int i = 0; i < 50; ++i) {
        text += body("Pressure [ Pa ],Temperature", "1,2", "b" + std::to_string(i));
    }
    EXPECT_EQ(read_text(text).problems.size(), 1U);
}

TEST(CfdPostCsv, ThousandsOfColumnsAreReadAndMoreRefused) {
    std::string header = "c0";
    std::string values = "0";
    for (int c = 1; c < 5000; ++c) {
        header += ",c" + std::to_string(c);
        values += ",1";
    }
    const double begin = test::processor_seconds();
    EXPECT_EQ(read_text(body(header, values)).zones[0].arrays.size(), 5000U);
    for (int c = 0; c < 200000; ++c) {
        header += ",d" + std::to_string(c);
    }
    EXPECT_THAT(failure(body(header, values)), HasSubstr("205003 columns"));
    EXPECT_LT(test::processor_seconds() - begin, 20);
}

TEST(CfdPostCsv, SurvivesRandomDamage) {
    core::Random random(5);
    for (int i = 0; i < 800; ++i) {
        std::string text = good;
        const int hits = 1 + static_cast<int>(random.uniform(0, 4));
        for (int k = 0; k < hits; ++k) {
            const auto at = static_cast<std::size_t>(random.uniform(0, static_cast<double>(text.size())));
            static const std::string signs = "[],;\n\r 0129-+eE.#\t\"x\x80";
            text[at] = signs[static_cast<std::size_t>(random.uniform(0, static_cast<double>(signs.size())))];
        }
        try {
            read_text(text);
        } catch (const core::InputError& error) {
            EXPECT_FALSE(error.message().empty());
        }
    }
}

TEST(CfdPostCsv, ReadsTheSampleFiles) {
    UNDERBODY_NEEDS_SHARED("samples/cfx_csv/R37_inlet.csv");
    const auto folder = test::shared_folder() / "samples/cfx_csv";
    const Field inlet = read_field(folder / "R37_inlet.csv");
    EXPECT_EQ(inlet.zones[0].name, "Inflow");
    EXPECT_EQ(inlet.zones[0].find("pressure_total")->original_unit, "Pa");
    const Field blades = read_field(folder / "11_blades_mode_1_ND_0.csv");
    EXPECT_EQ(blades.zones[0].surface->GetNumberOfPoints(), 9526);  // as its parameter Nnodes says
    EXPECT_NEAR(blades.zones[0].surface->GetPoint(0)[0], -5.13577717e-3, 1e-15);
    EXPECT_EQ(read_field(folder / "R37_mode1_1p.csv").zones[0].name, "mode1");
}

}  // namespace
}  // namespace underbody::postproc
