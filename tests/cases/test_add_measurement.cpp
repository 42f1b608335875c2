// Measurements for a study: what a log or a table of runs becomes, and what is refused before anything is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/add_measurement.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "surrogates/dynamics/model/measurements.h"
#include "tests/support/support.h"

namespace {

using namespace underbody;
using namespace underbody::cases;
namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

class AddMeasurement : public testing::Test {
protected:
    AddMeasurement() {
        fs::create_directories(folder.path() / "study");
        core::write_file(study() / "study.toml", "title = \"one\"\n");
        core::write_file(study() / "model.toml",
                         "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.7 kg\"\nnet_weight = \"0.8 N\"\n");
    }
    [[nodiscard]] fs::path study() const { return folder.path() / "study"; }
    /// A table of 60 rows with these headings: time in ms, then numbers that rise.
    fs::path table(const std::string& name, const std::string& headings, double per_time = 20) const {
        std::string text = headings + "\n";
        for (int row = 0; row < 60; ++row) {
            text += core::format_number(per_time * row, 8);
            for (auto column = std::count(headings.begin(), headings.end(), ','); column-- > 0;) {
                text += "," + core::format_number(1 + 0.01 * row, 6);
            }
            text += "\n";
        }
        core::write_file(folder.path() / name, text);
        return folder.path() / name;
    }
    [[nodiscard]] NewMeasurement of(const fs::path& data) const {
        NewMeasurement wanted;
        wanted.name = "flight";
        wanted.data = {data};
        wanted.model = study() / "model.toml";
        return wanted;
    }
    core::TemporaryFolder folder;
};

// What [log] does not list is not read: the input would be lost without a word.
TEST_F(AddMeasurement, KeepsTheColumnsThatAreCalledByTheirQuantity) {
    NewMeasurement wanted = of(table("run.csv", "t_ms,rng_cm,input_force [N],remark"));
    wanted.channels = {measured_channel("gap=rng_cm:cm")};
    wanted.clock = "t_ms";
    wanted.clock_unit = "ms";
    const AddedMeasurement added = with_new_measurement(study(), wanted);
    EXPECT_THAT(added.said, HasSubstr("60 rows"));
    write_added(added);
    const auto data = dynamics::read_measurements(added.dataset.parent_path());
    const core::Table& run = data.runs.front().table;
    ASSERT_NE(run.find("input_force"), nullptr);
    EXPECT_EQ(run.find("remark"), nullptr);
    EXPECT_DOUBLE_EQ(run.find("input_force")->numbers[10], 1.1);
    EXPECT_DOUBLE_EQ(run.find("gap")->numbers[10], 0.011);
    EXPECT_DOUBLE_EQ(run.find("time")->numbers[10], 0.2);
}

TEST_F(AddMeasurement, AClockAloneIsEnoughWhereTheGapHasItsName) {
    NewMeasurement wanted = of(table("run.csv", "t_us,gap [mm]", 20000));
    wanted.clock = "t_us";
    wanted.clock_unit = "us";
    write_added(with_new_measurement(study(), wanted));
    const auto data = dynamics::read_measurements(study() / "measurements" / "flight");
    EXPECT_DOUBLE_EQ(data.runs.front().table.find("time")->numbers[50], 1.0);
    EXPECT_DOUBLE_EQ(data.runs.front().table.find("gap")->numbers[0], 1e-3);
}

// A table of ours may not have them; of a logger's table the mapping says the unit.
TEST_F(AddMeasurement, QuantitiesWithoutAUnitInTheHeadingTakeTheOneThatIsStated) {
    const fs::path file = table("run.csv", "time,gap,input_force [N]", 0.02);
    const auto fields = measured_fields(file);
    ASSERT_EQ(guessed_channels(fields).size(), 1U);  // so that the unit can be said
    EXPECT_EQ(text_of(guessed_channels(fields)[0]), "gap=gap");
    NewMeasurement wanted = of(file);
    wanted.channels = {measured_channel("gap=gap:mm")};
    write_added(with_new_measurement(study(), wanted));
    const auto data = dynamics::read_measurements(study() / "measurements" / "flight");
    const core::Table& run = data.runs.front().table;
    EXPECT_DOUBLE_EQ(run.find("gap")->numbers[10], 1.1e-3);
    EXPECT_DOUBLE_EQ(run.find("time")->numbers[50], 1.0);
    EXPECT_DOUBLE_EQ(run.find("input_force")->numbers[10], 1.1);
    NewMeasurement silent = of(table("bare.csv", "time,gap,input_force", 0.02));
    silent.channels = {measured_channel("gap=gap:mm")};
    silent.name = "bare";
    try {  // that of the input is said by nobody: not taken for newtons in silence
        static_cast<void>(with_new_measurement(study(), silent));
        FAIL() << "taken";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("column 'input_force' has no unit"));
    }
}

TEST_F(AddMeasurement, HeadingsAreGuessedByTheWordsThatTablesAreReadWith) {
    const auto guess = [](const std::string& field, const std::string& unit = {}) {
        const auto found = guessed_channels({{"", "time", "s"}, {"", field, unit}});
        return found.empty() ? std::string() : text_of(found[0]);
    };
    EXPECT_EQ(guess("rng_cm"), "gap=rng_cm:cm");
    EXPECT_EQ(guess("Ride height", "mm"), "gap=Ride height");
    EXPECT_EQ(guess("clearance_mm"), "gap=clearance_mm:mm");
    EXPECT_EQ(guess("distance", "m"), "gap=distance");
    EXPECT_EQ(guess("range", "V"), "");  // another dimension
    EXPECT_EQ(guess("input_force", "N"), "");
    EXPECT_EQ(guessed_clock({{"", "t_us", ""}, {"", "gap", "mm"}}), "t_us:us");
    EXPECT_EQ(guessed_clock({{"", "timestamp", "ms"}, {"", "gap", "mm"}}), "timestamp");
    EXPECT_EQ(guessed_clock({{"", "stamp_ms", ""}, {"", "gap", "mm"}}), "stamp_ms:ms");
    EXPECT_EQ(guessed_clock({{"", "T", "K"}, {"", "gap", "mm"}}), "");
}

TEST_F(AddMeasurement, AByteOrderMarkIsNoPartOfAHeading) {
    const fs::path file = table("run.csv", "\xef\xbb\xbftime [s],gap [mm]", 0.02);
    EXPECT_THAT(with_new_measurement(study(), of(file)).dataset_text, HasSubstr("kind = \"time_series\""));
    EXPECT_EQ(measured_fields(file).front().field, "time");
}

TEST_F(AddMeasurement, IsReadFromWhereALinkToTheStudyEnds) {
    fs::create_directories(folder.path() / "elsewhere" / "deep");
    fs::create_directory_symlink(study(), folder.path() / "elsewhere" / "deep" / "link");
    NewMeasurement wanted = of(table("run.csv", "time [s],gap [mm]", 0.02));
    wanted.model = folder.path() / "elsewhere" / "deep" / "link" / "model.toml";
    write_added(with_new_measurement(folder.path() / "elsewhere" / "deep" / "link", wanted));
    for (const fs::path& way : {study(), folder.path() / "elsewhere" / "deep" / "link"}) {
        const Study read = Study::open(way);
        ASSERT_EQ(read.measurements.size(), 1u);
        EXPECT_EQ(dynamics::read_measurements(read.measurements.front().data).runs.size(), 1u) << way;
        EXPECT_TRUE(fs::exists(read.measurements.front().model)) << way;
    }
}

TEST_F(AddMeasurement, AWriteThatFailsIsNotInTheWayOfTheNext) {
    AddedMeasurement added = with_new_measurement(study(), of(table("run.csv", "time [s],gap [mm]", 0.02)));
    added.file = study() / "nowhere" / "study.toml";
    core::write_file(study() / "nowhere", "a file where a folder would have to be");
    EXPECT_THROW(write_added(added), core::Error);
    EXPECT_FALSE(fs::exists(added.dataset));
    EXPECT_NO_THROW((void)with_new_measurement(study(), of(folder.path() / "run.csv")));
}

// A table of loads beside CFD files does not make a measurement of their folder.
TEST_F(AddMeasurement, AFolderOfFieldsIsNone) {
    table("run.csv", "time [s],gap [mm]", 0.02);
    EXPECT_TRUE(holds_measurements(folder.path() / "run.csv"));
    fs::create_directories(folder.path() / "mixed");
    fs::copy(folder.path() / "run.csv", folder.path() / "mixed" / "loads.csv");
    EXPECT_TRUE(holds_measurements(folder.path() / "mixed"));
    fs::copy(test::data_folder() / "openfoam" / "ascii", folder.path() / "mixed" / "case", fs::copy_options::recursive);
    EXPECT_FALSE(holds_measurements(folder.path() / "mixed"));
}

}  // namespace
