// What people wrote for 0.1.0 (tests/data/versions/0.1.0: the files of its shipped study) is read, with the same
// meaning.
#include <gtest/gtest.h>

#include "cases/study.h"
#include "core/file.h"
#include "geometry/body/body_shape.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "tests/support/support.h"

namespace underbody::cases {
namespace {

namespace fs = std::filesystem;

class FirstVersion : public testing::Test {
protected:
    core::TemporaryFolder folder;

    /// Its files beside the fields, tables and runs of today's study, which they name.
    void SetUp() override {
        const fs::path today = test::source_folder() / "cases" / "evie";
        fs::create_directories(folder.path() / "heave");
        for (const char* data : {"fields", "tables", "forces.csv"}) {
            fs::create_symlink(today / data, folder.path() / data);
        }
        for (const auto& entry : fs::directory_iterator(today / "heave")) {
            if (entry.path().extension() == ".csv") {
                fs::create_symlink(entry.path(), folder.path() / "heave" / entry.path().filename());
            }
        }
        fs::copy(test::data_folder() / "versions" / "0.1.0", folder.path(), fs::copy_options::recursive);
    }
};

TEST_F(FirstVersion, StudyIsRead) {
    const Study study = Study::open(folder.path());
    EXPECT_EQ(study.title, "EVIE over a moving ground");
    EXPECT_EQ(study.bodies.size(), 4U);
    EXPECT_EQ(study.verifications.size(), 2U);
    EXPECT_EQ(study.pictures.size(), 3U);
    EXPECT_EQ(study.tables.size(), 7U);
    EXPECT_EQ(study.regions.size(), 1U);
    EXPECT_EQ(study.measurements.size(), 1U);
    EXPECT_GT(study.cases.size(), 30U);
}

TEST_F(FirstVersion, ModelsAndMeasurementsAreRead) {
    const dynamics::Model vehicle = dynamics::read_model(folder.path() / "model.toml");
    EXPECT_DOUBLE_EQ(vehicle.vehicle.mass, 2.2);
    EXPECT_DOUBLE_EQ(vehicle.vehicle.base_half_length, 0.0717);
    EXPECT_FALSE(vehicle.forces.empty());
    EXPECT_DOUBLE_EQ(dynamics::read_model(folder.path() / "glide.toml").vehicle.net_weight, 0.3);
    const dynamics::Model measured = dynamics::read_model(folder.path() / "heave" / "model.toml");
    EXPECT_DOUBLE_EQ(measured.vehicle.mass, 2.2);
    EXPECT_EQ(dynamics::read_measurements(folder.path() / "heave").runs.size(), 8U);
}

TEST_F(FirstVersion, ShapesAreThoseOfToday) {
    std::size_t read = 0;
    for (const auto& entry : fs::directory_iterator(folder.path() / "shapes")) {
        const fs::path today = test::source_folder() / "cases" / "evie" / "shapes" / entry.path().filename();
        EXPECT_EQ(geometry::read_shape(entry.path()), geometry::read_shape(today)) << entry.path();
        ++read;
    }
    EXPECT_EQ(read, 7U);
}

}  // namespace
}  // namespace underbody::cases
