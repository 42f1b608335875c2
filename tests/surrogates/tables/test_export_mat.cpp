// The .mat read by matio, and its .m run by Octave, evaluate like the table.
#include <gtest/gtest.h>
#include <matio.h>

#include <map>

#include "tests/surrogates/tables/exports_support.h"
#include "tests/surrogates/tables/json_evaluator.h"

namespace underbody {
namespace {

using tables::ForceTable;

std::map<std::string, std::vector<double>> read_by_matio(const std::filesystem::path& path,
                                                         const std::vector<std::string>& names) {
    std::map<std::string, std::vector<double>> read;
    mat_t* file = Mat_Open(path.c_str(), MAT_ACC_RDONLY);
    for (const auto& name : names) {
        matvar_t* v = file == nullptr ? nullptr : Mat_VarRead(file, name.c_str());
        if (v == nullptr) {
            ADD_FAILURE() << name << " cannot be read";
            continue;
        }
        const auto* data = static_cast<const double*>(v->data);
        read[name].assign(data, data + v->nbytes / sizeof(double));
        Mat_VarFree(v);
    }
    Mat_Close(file);
    return read;
}

/// The numbers of the file in the words of the JSON.
nlohmann::json as_json(const std::filesystem::path& path, std::size_t axes) {
    std::vector<std::string> names = {"hermite", "sigma", "growth", "outside", "lower", "upper", "support"};
    for (std::size_t k = 0; k < axes; ++k) {
        names.push_back("x" + std::to_string(k));
        names.push_back("cell_error" + std::to_string(k));
    }
    auto read = read_by_matio(path, names);
    if (read["support"].at(0) != 0) {
        names = {"has_data"};
        for (std::size_t k = 0; k < axes; ++k) {
            names.push_back("known" + std::to_string(k));
        }
        read.merge(read_by_matio(path, names));
    }
    nlohmann::json j;
    const char* words[] = {"clamp", "refuse", "extrapolate"};
    for (std::size_t k = 0; k < axes; ++k) {
        j["axes"].push_back({{"points", read["x" + std::to_string(k)]},
                             {"outside", words[static_cast<int>(read["outside"].at(k))]},
                             {"lower", read["lower"].at(k)},
                             {"upper", read["upper"].at(k)}});
        if (read.contains("has_data")) {
            j["support"]["lines"].push_back(read["known" + std::to_string(k)]);
        }
        j["cell_error"].push_back(read["cell_error" + std::to_string(k)]);
        j["growth"].push_back({read["growth"].at(k), read["growth"].at(axes + k)});
    }
    j["sigma"] = read["sigma"];
    if (read.contains("has_data")) {
        j["support"]["has_data"] = read["has_data"];
    }
    const std::size_t width = std::size_t{1} << axes;
    for (std::size_t i = 0; i < read["hermite"].size(); i += width) {
        j["hermite"].push_back(std::vector<double>(&read["hermite"][i], &read["hermite"][i] + width));
    }
    return j;
}

TEST(ExportsOfMat, ReadBackByMatioEvaluateLikeTheTable) {
    core::TemporaryFolder folder;
    for (const ForceTable& table : test::tables_of_all_policies()) {
        const std::size_t n = table.axes().size();
        ASSERT_EQ(export_table(table, "mat", folder.path() / "lift.mat").files.size(), 2u);
        const test::JsonTable by_matio{as_json(folder.path() / "lift.mat", n)};
        const auto points = test::random_points(table, 10000);
        const test::Sizes sizes(table, points);
        for (std::size_t i = 0; i < points.size(); i += n) {
            const auto v = by_matio.at(&points[i]);
            ASSERT_NO_FATAL_FAILURE(
                test::expect_alike(table, &points[i], sizes, 1e-12, v.value, v.slope, v.sigma, v.outside, v.no_data));
        }
    }
}

TEST(ExportsOfMat, LookedUpByOctaveEvaluateLikeTheTable) {
    if (!test::have("octave-cli") && !test::have("octave")) {
        GTEST_SKIP() << "skipped: Octave is not installed; the .m file was not run";
    }
    core::TemporaryFolder folder;
    std::string script;
    const auto all = test::tables_of_all_policies();
    for (std::size_t t = 0; t < all.size(); ++t) {
        const std::string id = std::to_string(t);
        export_table(all[t], "mat", folder.path() / ("lift" + id + ".mat"));
        test::write_doubles(folder.path() / ("points" + id), test::random_points(all[t], 10000));
        script += "f=fopen('points" + id + "');p=reshape(fread(f,'double')," + std::to_string(all[t].axes().size()) +
                  ",[])';fclose(f);[v,s,g,o,e]=lift" + id + "_at(p);f=fopen('out" + id +
                  "','w');fwrite(f,[v s g o e]','double');fclose(f);";
    }
    const std::string command = "cd '" + folder.path().string() +
                                "' && $(command -v octave-cli || command -v octave) --eval \"" + script +
                                "\" > errors.txt 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << core::read_file(folder.path() / "errors.txt");
    for (std::size_t t = 0; t < all.size(); ++t) {
        const std::size_t n = all[t].axes().size();
        const auto points = test::random_points(all[t], 10000);
        const auto out = test::read_doubles(folder.path() / ("out" + std::to_string(t)));
        ASSERT_EQ(out.size(), 10000 * (n + 4));
        const test::Sizes sizes(all[t], points);
        for (std::size_t i = 0; i < 10000; ++i) {
            const double* o = &out[(n + 4) * i];
            ASSERT_NO_FATAL_FAILURE(test::expect_alike(all[t], &points[i * n], sizes, 1e-12, o[0], o + 1, o[n + 1],
                                                       o[n + 2] != 0, o[n + 3] != 0));
        }
    }
}

TEST(ExportsOfMat, OfSeveralForcesAndOfOtherFilesAreLookedUpWithoutMixingThem) {
    if (!test::have("octave-cli") && !test::have("octave")) {
        GTEST_SKIP() << "skipped: Octave is not installed; the .m file was not run";
    }
    core::TemporaryFolder folder;
    const std::vector<ForceTable> both{test::sum_of_tables(), test::sum_of_tables("clamp", "side_force")};
    const ForceTable other = test::two_axes();
    export_tables(both, "mat", folder.path() / "body.mat");
    export_table(other, "mat", folder.path() / "other.mat");
    const auto points = test::random_points(both[0], 2000);
    test::write_doubles(folder.path() / "points", points);
    // The table of another file is looked up in between; the next call without a file is that of the body again.
    const std::string script =
        "f=fopen('points');p=reshape(fread(f,'double'),2,[])';fclose(f);a=body_at(p);b=body_at(p,'other.mat');[v,s,g,o,"
        "e]=body_at(p);"
        "f=fopen('out','w');fwrite(f,[a b v s(:,:,1) s(:,:,2) g o e]','double');fclose(f);";
    ASSERT_EQ(
        std::system(("cd '" + folder.path().string() + "' && $(command -v octave-cli || command -v octave) --eval \"" +
                     script + "\" > errors.txt 2>&1")
                        .c_str()),
        0)
        << core::read_file(folder.path() / "errors.txt");
    const auto out = test::read_doubles(folder.path() / "out");
    constexpr std::size_t width = 2 + 1 + 2 + 4 + 2 + 2;
    ASSERT_EQ(out.size(), 2000 * width);
    const test::Sizes sizes[2] = {{both[0], points}, {both[1], points}}, size_of_other(other, points);
    for (std::size_t i = 0; i < 2000; ++i) {
        const double* o = &out[width * i];
        ASSERT_NEAR(o[2], other.value(&points[2 * i]), 1e-12 * size_of_other.value);
        for (std::size_t q = 0; q < 2; ++q) {
            ASSERT_EQ(o[q], o[3 + q]);
            ASSERT_NO_FATAL_FAILURE(test::expect_alike(both[q], &points[2 * i], sizes[q], 1e-12, o[3 + q],
                                                       o + 5 + 2 * q, o[9 + q], o[11] != 0, o[12] != 0));
        }
    }
}

}  // namespace
}  // namespace underbody
