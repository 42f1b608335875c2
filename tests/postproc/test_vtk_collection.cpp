// ParaView's collections (.pvd): files of VTK with their times, parts at one time.
#include <gmock/gmock.h>

#include "core/file.h"
#include "postproc/field/times.h"
#include "postproc/field/vtk_files.h"
#include "tests/postproc/made_zones.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

std::string entry(const std::string& time, const std::string& part, const std::string& file) {
    return "<DataSet timestep=\"" + time + "\" group=\"\" part=\"" + part + "\" file=\"" + file + "\"/>\n";
}

fs::path collection(const core::TemporaryFolder& folder, const std::string& entries) {
    const fs::path path = folder.path() / "run.pvd";
    core::write_file(path,
                     "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
                     "byte_order=\"LittleEndian\">\n<Collection>\n" +
                         entries + "</Collection>\n</VTKFile>\n");
    return path;
}

/// A body whose pressure is the same everywhere, as one file.
void write_body(const fs::path& path, double pressure) {
    write_vtk(field_of({ellipsoid(8, {1, 1, 1}, [&](const Vector&) { return pressure; })}), path);
}

double pressure_of(const Zone& zone) { return zone.surface->GetPointData()->GetArray("pressure")->GetComponent(0, 0); }

TEST(VtkCollection, IsReadAtEachOfItsTimes) {
    const core::TemporaryFolder folder;
    for (const int step : {0, 1, 2}) {
        write_body(folder.path() / ("run_" + std::to_string(step) + ".vtp"), 100 + step);
    }
    // Not in the order of their times, as an appended run writes them.
    const auto path = collection(
        folder, entry("0", "0", "run_0.vtp") + entry("0.5", "0", "run_2.vtp") + entry("0.25", "0", "run_1.vtp"));
    const Field last = read_field(path);
    EXPECT_EQ(last.format, "ParaView collection");
    EXPECT_EQ(stated_times(last), (std::vector<double>{0, 0.25, 0.5}));
    ASSERT_EQ(last.zones.size(), 1U);
    EXPECT_EQ(pressure_of(last.zones[0]), 102);
    EXPECT_EQ(last.files, (std::vector<std::string>{path.string(), (folder.path() / "run_2.vtp").string()}));
    ReadOptions options;
    options.time = 0.25;
    const Field middle = read_field(path, options);
    EXPECT_EQ(pressure_of(middle.zones.at(0)), 101);
    EXPECT_EQ(middle.zones[0].name, last.zones[0].name) << "one name at all times";
    options.time = 0.3;
    try {
        (void)read_field(path, options);
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.hint(), HasSubstr("0.25"));
    }
}

TEST(VtkCollection, PartsOfOneTimeAreReadTogether) {
    const core::TemporaryFolder folder;
    write_body(folder.path() / "hull.vtp", 1);
    write_body(folder.path() / "keel.vtp", 2);
    const auto path = collection(folder, entry("0", "0", "hull.vtp") + entry("0", "1", "keel.vtp"));
    const Field both = read_field(path);
    ASSERT_EQ(both.zones.size(), 2U);
    EXPECT_NE(both.zones[0].name, both.zones[1].name);
    EXPECT_TRUE(stated_times(both).empty()) << "one time is none to choose";
    ReadOptions one;
    one.zones = {both.zones[1].name};
    ASSERT_EQ(read_field(path, one).zones.size(), 1U);
    EXPECT_EQ(pressure_of(read_field(path, one).zones[0]), 2);
}

TEST(VtkCollection, WhatIsWrongIsSaid) {
    const core::TemporaryFolder folder;
    write_body(folder.path() / "hull.vtp", 1);
    core::write_file(folder.path() / "notes.txt", "no field");
    const auto said = [&](const std::string& entries) {
        try {
            (void)read_field(collection(folder, entries));
        } catch (const core::InputError& error) {
            return std::string(error.what());
        }
        return std::string("nothing");
    };
    EXPECT_THAT(said(""), HasSubstr("names no files"));
    EXPECT_THAT(said(entry("0", "0", "hul.vtp")), HasSubstr("'hul.vtp' of this collection is not there"));
    EXPECT_THAT(said(entry("soon", "0", "hull.vtp")), HasSubstr("timestep=\"soon\""));
    EXPECT_THAT(said(entry("0", "0", "notes.txt")), HasSubstr("'notes.txt' is no file of VTK"));
    EXPECT_THAT(said(entry("0", "0", "run.pvd")), HasSubstr("'run.pvd' is no file of VTK")) << "itself";
    EXPECT_THAT(said(entry("0", "0", "hull.vtp") + "<DataSet"), HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace underbody::postproc
