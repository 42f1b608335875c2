// CSV and JSON come back as the table that they were made from; the JSON evaluates by its own words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "surrogates/tables/analysis/equilibria.h"
#include "surrogates/tables/fit/table_batch.h"
#include "tests/surrogates/tables/exports_support.h"
#include "tests/surrogates/tables/json_evaluator.h"

namespace underbody {
namespace {

using tables::ForceTable;
using ::testing::HasSubstr;

void check_read_back(const std::string& format) {
    core::TemporaryFolder folder;
    auto all = test::tables_of_all_policies();
    all.push_back(test::ref_a_spline());
    for (const ForceTable& table : all) {
        const auto path = folder.path() / ("t." + format);
        export_table(table, format, path, {});
        const ForceTable again = ForceTable::read(path, "lift_force");
        EXPECT_EQ(again.kind(), "exported grid");
        const std::size_t n = table.axes().size();
        ASSERT_EQ(again.axes().size(), n);
        for (std::size_t k = 0; k < n; ++k) {
            EXPECT_EQ(again.axes()[k].range, table.axes()[k].range);
        }
        const auto points = test::random_points(table, 10000);
        const test::Sizes sizes(table, points);
        for (std::size_t i = 0; i < points.size(); i += n) {
            const auto e = test::expected(again, &points[i]);
            ASSERT_NO_FATAL_FAILURE(test::expect_alike(table, &points[i], sizes, 1e-12, e.at.value, e.at.slope.data(),
                                                       e.at.sigma, e.at.outside, e.at.no_data));
        }
    }
}

bool says_errors_go_apart(const ForceTable& table) {
    tables::EquilibriumOptions options;
    options.net_weight = 0.3;
    options.draws = 20;
    const auto all = tables::equilibria(table, options).remarks;
    return std::any_of(all.begin(), all.end(), [](const core::Problem& remark) {
        return remark.message.find("not which errors go together") != std::string::npos;
    });
}

/// A file of values has their errors, not their correlation: what rests on differences of values is told so.
TEST(ExportsOfText, StiffnessOfATableReadBackIsSaidToHaveTooSmallAnError) {
    core::TemporaryFolder folder;
    const std::string text =
        "gap [mm], lift_force [N], lift_force_sigma [N]\n1, 0.8, 0.01\n5, 0.5, 0.01\n9, 0.1, 0.01\n";
    const ForceTable table = ForceTable::fit(core::read_csv(std::string_view(text), "made"), "lift_force");
    EXPECT_FALSE(says_errors_go_apart(table));
    export_table(table, "csv", folder.path() / "t.csv", {});
    EXPECT_TRUE(says_errors_go_apart(ForceTable::read(folder.path() / "t.csv", "lift_force")));
}

TEST(ExportsOfText, OfCsvReadBackAsTheSameTable) { check_read_back("csv"); }
TEST(ExportsOfText, OfJsonReadBackAsTheSameTable) { check_read_back("json"); }

TEST(ExportsOfText, OfSeveralForcesReadBackEachAsItself) {
    core::TemporaryFolder folder;
    const std::vector<ForceTable> both{test::sum_of_tables(), test::sum_of_tables("clamp", "side_force")};
    for (const char* format : {"csv", "json"}) {
        const auto path = folder.path() / (std::string("t.") + format);
        tables::export_tables(both, format, path);
        for (const ForceTable& table : both) {
            const ForceTable again = ForceTable::read(path, table.quantity());
            EXPECT_EQ(again.kind(), "exported grid");
            EXPECT_EQ(again.axes()[0].lower, 0.002);
            EXPECT_EQ(again.axes()[0].upper, 0.05);
            const auto points = test::random_points(table, 2000);
            const test::Sizes sizes(table, points);
            for (std::size_t i = 0; i < points.size(); i += 2) {
                const auto e = test::expected(again, &points[i]);
                ASSERT_NO_FATAL_FAILURE(test::expect_alike(table, &points[i], sizes, 1e-12, e.at.value,
                                                           e.at.slope.data(), e.at.sigma, e.at.outside, e.at.no_data));
            }
        }
    }
    EXPECT_THROW(tables::export_tables({test::sum_of_tables(), test::one_axis()}, "csv", folder.path() / "x.csv"),
                 core::UsageError);
}

TEST(ExportsOfText, OfOlderVersionsAreReadWithTheirOnePolicyForAllAxes) {
    core::TemporaryFolder folder;
    export_table(test::two_axes("extrapolate"), "csv", folder.path() / "t.csv");
    std::string csv = core::read_file(folder.path() / "t.csv");
    const std::string now = R"("range":["extrapolate","extrapolate"])";
    ASSERT_NE(csv.find(now), std::string::npos);
    core::write_file(folder.path() / "old.csv", csv.replace(csv.find(now), now.size(), R"("range":"extrapolate")"));
    export_table(test::two_axes("extrapolate"), "json", folder.path() / "t.json");
    auto json = nlohmann::json::parse(core::read_file(folder.path() / "t.json"));
    json["outside"] = "extrapolate";
    for (auto& axis : json["axes"]) {
        for (const char* newer : {"outside", "lower", "upper"}) {
            axis.erase(newer);
        }
    }
    core::write_file(folder.path() / "old.json", json.dump());
    for (const char* name : {"old.csv", "old.json"}) {
        for (const auto& axis : ForceTable::read(folder.path() / name, "lift_force").axes()) {
            EXPECT_EQ(axis.range, tables::RangePolicy::extrapolate) << name;
        }
        // What the caller says goes first.
        tables::FitOptions options;
        options.range = tables::parse_range_policies("gap=clamp");
        const auto table = ForceTable::read(folder.path() / name, "lift_force", options);
        EXPECT_EQ(table.axes()[0].range, tables::RangePolicy::clamp) << name;
        EXPECT_EQ(table.axes()[1].range, tables::RangePolicy::extrapolate) << name;
    }
}

TEST(ExportsOfText, KeepTheConditionsOfTheTableAndWhereItsPointsAre) {
    std::string text =
        "# a diagonal band\ngap [mm], pitch [deg], speed [m/s], mass [kg], variant, lift_force [N], lift_force_sigma "
        "[N]\n";
    for (int i = 0; i < 9; ++i) {
        for (const int j : {-1, 0, 1}) {
            text += std::to_string(2 + i) + "," + std::to_string(0.5 * (i + j) - 2) + ",0.5,2.2,ellipse," +
                    std::to_string(0.6 - 0.05 * i + 0.02 * j) + ",0.01\n";
        }
    }
    const auto table = ForceTable::fit(test::csv(text), "lift_force");
    core::TemporaryFolder folder;
    for (const char* name : {"t.csv", "t.json"}) {
        export_table(table, std::string(name).substr(2), folder.path() / name);
        const auto again = ForceTable::read(folder.path() / name, "lift_force");
        ASSERT_EQ(again.conditions().size(), 1u);
        EXPECT_EQ(again.conditions()[0], (std::pair<std::string, double>("speed", 0.5)));
        const double in_the_band[2] = {0.006, 0}, far_from_it[2] = {0.010, -0.034};
        EXPECT_NEAR(beyond_points(again, in_the_band), 0, 1e-9);
        EXPECT_GT(beyond_points(again, far_from_it), 0.1);
        EXPECT_NEAR(beyond_points(again, far_from_it), beyond_points(table, far_from_it), 1e-12);
        const std::string written = core::read_file(folder.path() / name);
        EXPECT_THAT(written, HasSubstr("Holds for speed = 0.5 m/s"));
        EXPECT_THAT(written, HasSubstr("Of mass = 2.2 kg"));
        EXPECT_THAT(written, HasSubstr("Of variant ellipse"));
        EXPECT_THAT(written, HasSubstr("The points do not fill the box of the axes"));
    }
}

TEST(ExportsOfText, WarningsAndWordsOfTheHeadTravelThroughCsvAndJson) {
    core::TemporaryFolder folder;
    core::Table points;
    points.source = "campaign.csv";
    points.add_numbers("gap", "m", {0.005, 0.006, 0.007, 0.008, 0.009, 0.010, 0.012, 0.015});
    points.add_numbers("lift_force", "N", {1, 0.9, 0.82, 0.77, 0.73, 0.70, 0.66, 0.62});
    points.add_text("variant", std::vector<std::string>(8, "ellipse"));
    std::vector<std::string> settled(8, "settled");
    settled[1] = "not settled";
    settled[2] = "unknown";
    points.add_text("settled", settled);
    const std::vector<std::string> words = {"1 of 8 points is of a solution that has not settled: row 2",
                                            "Whether 1 of the 8 solutions behind the points had settled is not known",
                                            "Of variant ellipse", "ade from campaign.csv: 8 points, fitted as "};
    const auto expect_words = [&](const std::filesystem::path& path) {
        const std::string head = core::read_file(path);
        for (const auto& sentence : words) {
            EXPECT_THAT(head, HasSubstr(sentence)) << path;
        }
    };
    std::filesystem::path last = folder.path() / "a.csv";
    const ForceTable fitted = ForceTable::fit(points, "lift_force");
    const auto warnings_of = [](const ForceTable& table) {
        std::vector<std::string> messages;
        for (const auto& remark : table.remarks()) {
            if (remark.severity == core::Problem::Severity::warning) {
                messages.push_back(remark.message);
            }
        }
        return messages;
    };
    EXPECT_THAT(warnings_of(fitted), testing::Contains(words[0]));
    export_table(fitted, "csv", last, {});
    expect_words(last);
    int turn = 0;
    for (const char* format : {"json", "csv", "csv", "json"}) {  // each out of the one before
        const ForceTable again = ForceTable::read(last, "lift_force");
        EXPECT_EQ(warnings_of(again), warnings_of(fitted)) << last;
        for (const char* made : {"c", "modelica", "jsbsim", "simulink"}) {
            const auto path = folder.path() / (std::string(made) + std::to_string(turn));
            const auto files = export_table(again, made, path, {}).files;
            std::string all;
            for (const auto& file : files) {
                all += core::read_file(file);
            }
            for (const auto& sentence : words) {
                EXPECT_THAT(all, HasSubstr(sentence)) << made << " of " << last;
            }
        }
        last = folder.path() / ("b" + std::to_string(++turn) + "." + format);
        export_table(again, format, last, {});
        expect_words(last);
    }
}

TEST(ExportsOfText, ThatAreNoTablesSayWhatIsWrong) {
    core::TemporaryFolder folder;
    const auto message = [&](const std::string& text) {
        core::write_file(folder.path() / "t.json", text);
        try {
            ForceTable::read(folder.path() / "t.json", "lift_force");
        } catch (const core::InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_THAT(message("{\"a\": }"), HasSubstr("not JSON"));
    EXPECT_THAT(message("{\"a\": 1}"), HasSubstr("not a force table"));
    EXPECT_THAT(message("{\"format\": \"Underbody force table\"}"), HasSubstr("not complete"));
    export_table(test::one_axis(), "json", folder.path() / "ours.json");
    auto json = nlohmann::json::parse(core::read_file(folder.path() / "ours.json"));
    json["hermite"].erase(json["hermite"].begin());
    EXPECT_THAT(message(json.dump()), HasSubstr("grid points together"));
}

TEST(ExportsOfText, ThatAreDamagedSayWhatIsWrong) {
    core::TemporaryFolder folder;
    export_table(test::one_axis(), "csv", folder.path() / "t.csv");
    const std::string csv = core::read_file(folder.path() / "t.csv");
    const auto message = [&](const std::string& from, const std::string& to) {
        std::string text = csv;
        EXPECT_NE(text.find(from), std::string::npos);
        core::write_file(folder.path() / "bad.csv", text.replace(text.find(from), from.size(), to));
        try {
            ForceTable::read(folder.path() / "bad.csv", "lift_force");
        } catch (const core::InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_THAT(message(R"("range":["clamp"])", R"("range":["hold"])"), HasSubstr("range policy \"hold\""));
    EXPECT_THAT(message(R"("axes":["gap"])", R"("axes":7)"), HasSubstr("damaged"));
}

TEST(ExportsOfText, OfJsonEvaluateByTheirOwnWords) {
    core::TemporaryFolder folder;
    for (const ForceTable& table : test::tables_of_all_policies()) {
        export_table(table, "json", folder.path() / "t.json", {});
        const test::JsonTable json{nlohmann::json::parse(core::read_file(folder.path() / "t.json"))};
        const std::size_t n = table.axes().size();
        const auto points = test::random_points(table, 10000);
        const test::Sizes sizes(table, points);
        for (std::size_t i = 0; i < points.size(); i += n) {
            const auto v = json.at(&points[i]);
            ASSERT_NO_FATAL_FAILURE(
                test::expect_alike(table, &points[i], sizes, 1e-12, v.value, v.slope, v.sigma, v.outside, v.no_data));
        }
    }
}

TEST(ExportText, TheHeadSaysInWordsWhetherTheSolutionsHadSettled) {
    const auto head = [](const std::string& first, const std::string& others) {
        std::string text = "gap [mm], lift_force [N], case, settled\n";
        for (int i = 0; i < 5; ++i) {
            text += std::to_string(1 + i) + "," + std::to_string(0.5 - 0.1 * i) + ",case-" + std::to_string(i) + "," +
                    (i == 0 ? first : others) + "\n";
        }
        const auto table = ForceTable::fit(test::csv(text), "lift_force");
        const core::TemporaryFolder folder;
        export_table(table, "c", folder.path() / "t.h");
        return core::read_file(folder.path() / "t.h");
    };
    EXPECT_THAT(head("settled", "settled"), HasSubstr("Every solution behind the points had settled"));
    EXPECT_THAT(head("unknown", "unknown"),
                HasSubstr("Whether the solutions behind the points had settled is not known"));
    EXPECT_THAT(head("unknown", "settled"), HasSubstr("Whether 1 of the 5 solutions behind the points had settled"));
    const std::string moving = head("not settled", "settled");
    EXPECT_THAT(moving, HasSubstr("WARNING: 1 of 5 points is of a solution that has not settled: case-0"));
    for (const std::string& one : {head("unknown", "unknown"), head("settled", "settled"), moving}) {
        EXPECT_EQ(one.find("Of settled"), std::string::npos);
    }
}

}  // namespace
}  // namespace underbody
