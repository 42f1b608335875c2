// What other results of a study say against one of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/doubts.h"

namespace underbody::cases {
namespace {

using testing::HasSubstr;

TEST(Doubts, AMapOfAModelThatTheRunsFindIncompleteSaysSo) {
    Study study;
    RegionSpec region;
    region.model = "/s/model.toml";
    study.measurements.push_back({"rig", "/s/./model.toml", "/s/rig", true});
    study.measurements.push_back({"other", "/s/other.toml", "/s/rig", true});
    StudyResults results;
    EXPECT_TRUE(doubts_of_model(study, results, region).empty());
    results.documents.emplace_back("discovery/other", R"({"effects": [{"name": "tether"}]})");
    results.documents.emplace_back("discovery/rig", R"({"effects": []})");
    EXPECT_TRUE(doubts_of_model(study, results, region).empty()) << "it lacks nothing";
    results.documents.back().second = R"({"effects": [{"name": "coulomb friction"}, {"name": "thrust by gap"}]})";
    const auto doubts = doubts_of_model(study, results, region);
    ASSERT_EQ(doubts.size(), 1U);
    EXPECT_THAT(doubts.front(),
                HasSubstr("'rig' find this model incomplete: it lacks coulomb friction, thrust by gap"));
}

TEST(Doubts, WhatAMeasurementWarnsOfIsSaidOnce) {
    const MeasurementSpec rig{"rig", "/s/model.toml", "/s/rig", true};
    StudyResults results;
    EXPECT_TRUE(warnings_of(rig, results).empty());
    const std::string problems =
        R"("problems": [{"severity": "warning", "message": "its noise is 3 times what is declared",
        "place": ""}, {"severity": "note", "message": "8 runs", "place": ""}])";
    results.documents.emplace_back("residual/rig", R"({"residuals": [{)" + problems + "}, {" + problems + "}]}");
    results.documents.emplace_back("discovery/rig", "{" + problems + "}");
    results.documents.emplace_back("residual/other", R"({"residuals": []})");
    EXPECT_THAT(warnings_of(rig, results), testing::ElementsAre("its noise is 3 times what is declared"));
    results.documents.front().second = R"({"residuals": [{}]})";  // of an earlier version
    results.documents.erase(results.documents.begin() + 1);
    EXPECT_TRUE(warnings_of(rig, results).empty());
}

TEST(Doubts, ATableSaysThatItsMeshStudyDiverges) {
    TableSpec table;
    table.quantity = "lift_force";
    table.mesh_uncertainty = "meshes";
    StudyResults results;
    EXPECT_TRUE(doubts_of_mesh(table, results).empty());
    results.meshes.push_back({"meshes", {1000, 8000, 64000}, {{"lift_force", {0.1, 0.11, 0.14}, "monotone", 0.017}}});
    EXPECT_TRUE(doubts_of_mesh(table, results).empty());
    results.meshes.front().quantities.front().verdict = "diverging";
    const auto doubts = doubts_of_mesh(table, results);
    ASSERT_EQ(doubts.size(), 1U);
    EXPECT_THAT(doubts.front(), HasSubstr("0.017 N is of the mesh study 'meshes', whose values are diverging"));
}

}  // namespace
}  // namespace underbody::cases
