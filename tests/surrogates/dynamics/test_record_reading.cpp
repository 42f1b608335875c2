// [records] of inputs beside input_force: as they acted, sample by sample, and in the file.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/file.h"
#include "models.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/simulate/read_records.h"

namespace underbody::dynamics {

namespace {

MeasuredRun with_moment(const std::vector<double>& values) {
    MeasuredRun run;
    std::vector<double> time;
    for (std::size_t k = 0; k < values.size(); ++k) {
        time.push_back(0.1 * static_cast<double>(k));
    }
    run.table.add_numbers("time", "s", time);
    run.table.add_numbers("input_moment", "N m", values);
    return run;
}

std::vector<double> acted(const MeasuredRun& run, const RecordReading& records) {
    std::vector<double> values;
    EXPECT_TRUE(as_acted(run, "input_moment", records, values));
    return values;
}

TEST(RecordReading, AHeldInputThatWasLoggedLateIsTheMeanOfWhatActedOverEachStep) {
    RecordReading records;
    records.others_advance = 0.15;
    records.factors["input_moment"] = -1;
    const std::vector<double> values = acted(with_moment({0, 0, 4, 8, 8, 8}), records);
    const std::vector<double> wanted{-2, -6, -8, -8, -8, -8};
    ASSERT_EQ(values.size(), wanted.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        EXPECT_NEAR(values[k], wanted[k], 1e-9) << k;
    }
}

TEST(RecordReading, ALinearInputThatWasLoggedLateIsItsLineEarlier) {
    RecordReading records;
    records.others_advance = 0.15;
    records.input_between = RecordReading::Between::linear;
    const std::vector<double> values = acted(with_moment({0, 0, 4, 8, NAN, 8}), records);
    const std::vector<double> wanted{2, 6, 8, 8, 8, 8};
    ASSERT_EQ(values.size(), wanted.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        EXPECT_NEAR(values[k], wanted[k], 1e-9) << k;
    }
}

TEST(RecordReading, StandsInTheFileByColumn) {
    Model model = test::spring_model(1.0, 4, 0.5, 0);
    model.records.others_advance = 0.2;
    model.records.scale("input_moment", -1);
    model.records.scale("input_force", 1e-3);
    const core::TemporaryFolder folder("record-reading");
    write_model(model, folder.path() / "model.toml");
    const Model again = read_model(folder.path() / "model.toml");
    EXPECT_EQ(again.records, model.records);
    EXPECT_EQ(again.records.factor_of("input_moment"), -1);
    EXPECT_EQ(again.records.factor_of("input_force"), 1e-3);
    EXPECT_EQ(again.records.factor_of("thrust_bow"), 1);
    model.records.scale("input_moment", -1);
    EXPECT_TRUE(model.records.factors.empty()) << "turned twice";
}

TEST(RecordReading, AFactorOfWhatIsNoInputIsRefused) {
    const std::string vehicle = "[vehicle]\nmass = \"1 kg\"\nnet_weight = \"0.1 N\"\n";
    for (const char* wrong :
         {"[records.factors]\ninput_momnet = -1\n", "[records.factors]\nthrust_bow = -1\n",
          "[records.factors]\ninput_moment = 0\n", "[records]\nother_inputs_advance = \"-0.1 s\"\n"}) {
        EXPECT_THROW(read_model_text(vehicle + wrong, "model.toml", "."), core::InputError) << wrong;
    }
}

}  // namespace

}  // namespace underbody::dynamics
