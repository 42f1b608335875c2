// Steps in time of CGNS files: solutions, grids, zones and bases of each.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkPointData.h>

#include <optional>

#include "cgns_files.h"
#include "core/file.h"
#include "import_support.h"

namespace underbody {

using postproc::read_field;
using test::CgnsWriter;
using test::told;
using ::testing::HasSubstr;
using ::testing::Not;

namespace {

namespace fs = std::filesystem;

/// Names of 32 characters each, padded.
std::string padded(const std::vector<std::string>& names) {
    std::string text;
    for (const auto& name : names) {
        text += name + std::string(32 - name.size(), ' ');
    }
    return text;
}

void write_times(CgnsWriter& file, const std::vector<double>& times) {
    const auto count = static_cast<cgsize_t>(times.size());
    CgnsWriter::ok(cg_biter_write(file.file, file.base, "Steps", static_cast<int>(times.size())));
    CgnsWriter::ok(cg_goto(file.file, file.base, "BaseIterativeData_t", 1, "end"));
    CgnsWriter::ok(cg_array_write("TimeValues", CGNS_ENUMV(RealDouble), 1, &count, times.data()));
}

void write_pointers(CgnsWriter& file, const std::string& array, const std::vector<std::string>& names) {
    if (cg_goto(file.file, file.base, "Zone_t", file.zone, "ZoneIterativeData_t", 1, "end") != CG_OK) {
        CgnsWriter::ok(cg_ziter_write(file.file, file.base, file.zone, "ZoneSteps"));
        CgnsWriter::ok(cg_goto(file.file, file.base, "Zone_t", file.zone, "ZoneIterativeData_t", 1, "end"));
    }
    const cgsize_t size[2] = {32, static_cast<cgsize_t>(names.size())};
    CgnsWriter::ok(cg_array_write(array.c_str(), CGNS_ENUMV(Character), 2, size, padded(names).c_str()));
}

postproc::Field read_at(const fs::path& path, std::optional<double> time) {
    postproc::ReadOptions options;
    options.time = time;
    return read_field(path, options);
}

/// The value of the only volume, the same all over it.
double value_of(const postproc::Field& field, const char* array) {
    for (const auto& zone : field.zones) {
        if (zone.volume != nullptr) {
            auto* cells = zone.volume->GetCellData()->GetArray(array);
            auto* nodes = zone.volume->GetPointData()->GetArray(array);
            return cells != nullptr ? cells->GetTuple1(0) : nodes != nullptr ? nodes->GetTuple1(0) : -1;
        }
    }
    return -1;
}
double pressure_of(const postproc::Field& field) { return value_of(field, "pressure"); }

std::string refusal_at(const fs::path& path, double time) {
    postproc::ReadOptions options;
    options.time = time;
    return test::refusal(path, options);
}

}  // namespace

TEST(CgnsSteps, SolutionsOfCellsAndVerticesHavePointersOfTheirOwn) {
    const core::TemporaryFolder folder;
    const fs::path path = folder.path() / "a.cgns";
    {
        CgnsWriter file(path);
        file.add_cube("water");
        write_times(file, {0.1, 0.2});
        file.solution("C1", CGNS_ENUMV(CellCenter), "Pressure", {1});
        file.solution("C2", CGNS_ENUMV(CellCenter), "Pressure", {2});
        file.solution("V1", CGNS_ENUMV(Vertex), "Temperature", std::vector<double>(8, 301));
        file.solution("V2", CGNS_ENUMV(Vertex), "Temperature", std::vector<double>(8, 302));
        file.solution("Mean", CGNS_ENUMV(CellCenter), "Pressure", {77});
        write_pointers(file, "FlowSolutionCellPointers", {"C1", "C2"});
        write_pointers(file, "FlowSolutionVertexPointers", {"V1", "V2"});
    }
    for (const auto& [time, step] : {std::pair{std::optional(0.1), 1.0}, std::pair{std::optional(0.2), 2.0},
                                     std::pair{std::optional<double>(), 2.0}}) {
        const auto field = read_at(path, time);
        EXPECT_EQ(pressure_of(field), step);
        EXPECT_EQ(value_of(field, "temperature"), 300 + step);
        EXPECT_THAT(told(field), Not(HasSubstr("does not say")));
    }
}

TEST(CgnsSteps, ATimeIsRefusedWhereTheFileDoesNotSayWhichSolutionsAreOfIt) {
    const core::TemporaryFolder folder;
    const fs::path path = folder.path() / "a.cgns";
    {
        CgnsWriter file(path);
        file.add_cube("water");
        write_times(file, {0.1, 0.2, 0.3});
        for (const int step : {1, 2, 3}) {
            file.solution("Sol" + std::to_string(step), CGNS_ENUMV(Vertex), "Pressure", std::vector<double>(8, step));
        }
    }
    EXPECT_THAT(refusal_at(path, 0.1),
                HasSubstr("holds Pressure in several solutions and does not say of which times"));
    const auto last = read_at(path, {});
    EXPECT_EQ(pressure_of(last), 3);
    EXPECT_THAT(told(last), HasSubstr("the last is read, 'Sol3'"));
    {
        CgnsWriter file(folder.path() / "one.cgns");
        file.add_cube("water");
        write_times(file, {0.1, 0.2, 0.3});
        file.solution("Sol", CGNS_ENUMV(Vertex), "Pressure", std::vector<double>(8, 1));
    }
    EXPECT_THAT(told(read_at(folder.path() / "one.cgns", 0.2)),
                HasSubstr("does not say of which time its solution 'Sol' is"));
    {
        CgnsWriter file(folder.path() / "none.cgns");
        file.add_cube("water");
        file.solution("Sol", CGNS_ENUMV(Vertex), "Pressure", std::vector<double>(8, 1));
    }
    EXPECT_THAT(refusal_at(folder.path() / "none.cgns", 0.1), HasSubstr("the file states no times"));
}

TEST(CgnsSteps, SolutionsOfPartsAloneAreLeftOutAloud) {
    const core::TemporaryFolder folder;
    const fs::path path = folder.path() / "a.cgns";
    {
        CgnsWriter file(path);
        file.add_cube("water");
        file.solution("All", CGNS_ENUMV(CellCenter), "Pressure", {5});
        file.section("faces", CGNS_ENUMV(QUAD_4), CgnsWriter::cube_faces(), 4);
        const cgsize_t nodes[2] = {1, 3};
        int index = 0;
        CgnsWriter::ok(cg_sol_ptset_write(file.file, file.base, file.zone, "Some", CGNS_ENUMV(Vertex),
                                          CGNS_ENUMV(PointRange), 2, nodes, &index));
        const double values[3] = {1, 2, 3};
        int field = 0;
        CgnsWriter::ok(cg_field_write(file.file, file.base, file.zone, index, CGNS_ENUMV(RealDouble), "Temperature",
                                      values, &field));
    }
    const auto field = read_at(path, {});
    EXPECT_EQ(pressure_of(field), 5);
    EXPECT_THAT(told(field), HasSubstr("solution 'Some' is not read"));
}

TEST(CgnsSteps, AMovingGridIsThatOfTheStep) {
    const core::TemporaryFolder folder;
    for (const bool pointers : {true, false}) {
        for (const int rind : {0, 2}) {
            const fs::path path = folder.path() / ("a" + std::to_string(rind) + (pointers ? "p" : "") + ".cgns");
            {
                CgnsWriter file(path);
                file.add_block("water", {1, 1, 1});
                write_times(file, {0.1, 0.2});
                int grid = 0;
                CgnsWriter::ok(cg_grid_write(file.file, file.base, file.zone, "Later", &grid));
                CgnsWriter::ok(cg_goto(file.file, file.base, "Zone_t", file.zone, "GridCoordinates_t", grid, "end"));
                const std::array<int, 6> planes = {rind, 0, 0, 0, 0, 0};
                if (rind > 0) {
                    CgnsWriter::ok(cg_rind_write(planes.data()));
                }
                const std::array<cgsize_t, 3> size = {2 + rind, 2, 2};
                std::array<std::vector<double>, 3> x;
                for (int k = 0; k < 2; ++k) {
                    for (int j = 0; j < 2; ++j) {
                        for (int i = -rind; i < 2; ++i) {
                            x[0].push_back(3 * i);
                            x[1].push_back(j);
                            x[2].push_back(k);
                        }
                    }
                }
                CgnsWriter::ok(cg_array_write("CoordinateX", CGNS_ENUMV(RealDouble), 3, size.data(), x[0].data()));
                CgnsWriter::ok(cg_array_write("CoordinateY", CGNS_ENUMV(RealDouble), 3, size.data(), x[1].data()));
                CgnsWriter::ok(cg_array_write("CoordinateZ", CGNS_ENUMV(RealDouble), 3, size.data(), x[2].data()));
                if (pointers) {
                    write_pointers(file, "GridCoordinatesPointers", {"GridCoordinates", "Later"});
                }
            }
            if (pointers) {
                EXPECT_NEAR(test::volume_of(read_at(path, 0.1)), 1, 1e-12);
                EXPECT_NEAR(test::volume_of(read_at(path, 0.2)), 3, 1e-12) << rind;
                EXPECT_NEAR(test::volume_of(read_at(path, {})), 3, 1e-12);
            } else {
                EXPECT_THAT(refusal_at(path, 0.2), HasSubstr("2 grids"));
                EXPECT_THAT(told(read_at(path, {})), HasSubstr("2 grids"));
            }
        }
    }
}

TEST(CgnsSteps, ZonesOfOtherStepsStayAway) {
    const core::TemporaryFolder folder;
    const fs::path path = folder.path() / "a.cgns";
    {
        CgnsWriter file(path);
        for (const int zone : {1, 2, 3}) {  // two in the second step
            file.add_cube("water " + std::to_string(zone));
            file.section("wall", CGNS_ENUMV(QUAD_4), CgnsWriter::cube_faces(), 4);
            file.solution("Sol", CGNS_ENUMV(Vertex), "Pressure", std::vector<double>(8, zone == 1 ? 1 : 2));
        }
        write_times(file, {0.1, 0.2});
        CgnsWriter::ok(cg_goto(file.file, file.base, "BaseIterativeData_t", 1, "end"));
        const cgsize_t steps = 2;
        const std::array<int, 2> zones = {1, 2};
        CgnsWriter::ok(cg_array_write("NumberOfZones", CGNS_ENUMV(Integer), 1, &steps, zones.data()));
        const std::array<cgsize_t, 3> size = {32, 2, 2};
        CgnsWriter::ok(cg_array_write("ZonePointers", CGNS_ENUMV(Character), 3, size.data(),
                                      padded({"water 1", "Null", "/Base/water 2", "water 3"}).c_str()));
    }
    for (const auto& [time, step] : {std::pair{std::optional(0.1), 1.0}, std::pair{std::optional(0.2), 2.0},
                                     std::pair{std::optional<double>(), 2.0}}) {
        const auto field = read_at(path, time);
        EXPECT_EQ(field.zones.size(), step == 1 ? 2U : 4U);
        EXPECT_EQ(pressure_of(field), step);
        EXPECT_THAT(told(field), Not(HasSubstr("does not say")));
    }
}

TEST(CgnsSteps, ABaseMayBeAStep) {
    const core::TemporaryFolder folder;
    const fs::path path = folder.path() / "a.cgns";
    {
        CgnsWriter file(path);
        for (const double time : {0.7, 0.8, 0.6}) {
            if (time != 0.7) {
                file.add_base("At " + std::to_string(time));
            }
            file.add_cube("water");
            write_times(file, {time});
            file.solution("Sol", CGNS_ENUMV(Vertex), "Pressure", std::vector<double>(8, time));
        }
    }
    for (const double time : {0.6, 0.7, 0.8}) {
        EXPECT_EQ(pressure_of(read_at(path, time)), time);
    }
    EXPECT_EQ(pressure_of(read_at(path, {})), 0.8);
    EXPECT_THAT(refusal_at(path, 0.75), HasSubstr("there is no time 0.75 s among the 3"));
}

}  // namespace underbody
