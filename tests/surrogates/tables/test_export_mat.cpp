// The .mat read by matio, and its .m run by Octave, evaluate like the table.
#include <gtest/gtest.h>
#include <matio.h>

#include <map>

#include "tests/surrogates/tables/exports_support.h"
#include "tests/surrogates/tables/json_evaluator.h"

namespace underbody {
namespace {

using tables::ForceTable;

std::map<std::string, std::vector<double>> read_by_matio(const std::filesystem::path& path, const std::vector<std::string>& names) {
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
    std::vector<std::string> names = {"hermite", "sigma", "growth", "outside"};
    for (std::size_t k = 0; k < axes; ++k) {
        names.push_back("x" + std::to_string(k));
        names.push_back("cell_error" + std::to_string(k));
    }
    auto read = read_by_matio(path, names);
    nlohmann::json j;
    const char* words[] = {"clamp", "refuse", "extrapolate"};
    for (std::size_t k = 0; k < axes; ++k) {
        j["axes"].push_back({{"points", read["x" + std::to_string(k)]}, {"outside", words[static_cast<int>(read["outside"].at(k))]}});
        j["cell_error"].push_back(read["cell_error" + std::to_string(k)]);
        j["growth"].push_back({read["growth"].at(k), read["growth"].at(axes + k)});
    }
    j["sigma"] = read["sigma"];
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
            ASSERT_NO_FATAL_FAILURE(test::expect_alike(table, &points[i], sizes, 1e-12, v.value, v.slope, v.sigma, v.outside));
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
        script += "f=fopen('points" + id + "');p=reshape(fread(f,'double')," + std::to_string(all[t].axes().size()) + ",[])';fclose(f);[v,s,g,o]=lift" + id +
                  "_at(p);f=fopen('out" + id + "','w');fwrite(f,[v s g o]','double');fclose(f);";
    }
    const std::string command = "cd '" + folder.path().string() + "' && $(command -v octave-cli || command -v octave) --eval \"" + script + "\" > errors.txt 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << core::read_file(folder.path() / "errors.txt");
    for (std::size_t t = 0; t < all.size(); ++t) {
        const std::size_t n = all[t].axes().size();
        const auto points = test::random_points(all[t], 10000);
        const auto out = test::read_doubles(folder.path() / ("out" + std::to_string(t)));
        ASSERT_EQ(out.size(), 10000 * (n + 3));
        const test::Sizes sizes(all[t], points);
        for (std::size_t i = 0; i < 10000; ++i) {
            const double* o = &out[(n + 3) * i];
            ASSERT_NO_FATAL_FAILURE(test::expect_alike(all[t], &points[i * n], sizes, 1e-12, o[0], o + 1, o[n + 1], o[n + 2] != 0));
        }
    }
}

}  // namespace
}  // namespace underbody
