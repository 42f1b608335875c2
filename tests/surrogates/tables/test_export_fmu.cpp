// The FMU, loaded by a small importer of FMI 2.0, evaluates like the table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "core/text.h"
#include "tests/surrogates/tables/exports_support.h"
#include "tests/surrogates/tables/fmu_loader.h"
#include "tests/surrogates/tables/fmu_wine.h"

namespace underbody {
namespace {

using tables::ForceTable;
using test::discard;
using test::Fmu;
using test::ok;
using test::unzipped;
using ::testing::HasSubstr;

/// The life of a model-exchange instance without states: events once, then continuous time.
void enter_continuous_time(Fmu& fmu, void* instance) {
    struct {
        int flags[5];
        double next;
    } event = {{1, 1, 1, 1, 1}, 0};
    ASSERT_EQ(fmu.call("fmi2NewDiscreteStates", instance, static_cast<void*>(&event)), ok);
    EXPECT_EQ(event.flags[0], 0) << "no further events";
    ASSERT_EQ(fmu.call("fmi2EnterContinuousTimeMode", instance), ok);
    ASSERT_EQ(fmu.call("fmi2SetTime", instance, 1.5), ok);
    double none = 0;
    ASSERT_EQ(fmu.call("fmi2GetDerivatives", instance, &none, std::size_t{0}), ok);
    int asks_event = 1, asks_end = 1;
    ASSERT_EQ(fmu.call("fmi2CompletedIntegratorStep", instance, 1, &asks_event, &asks_end), ok);
    EXPECT_EQ(asks_event + asks_end, 0);
}

/// Derivatives of every output along a direction: that of the value against the slopes of the table, at the ends of the
/// range too; all against differences of the outputs in the same cell (a place and its neighbours between two grid
/// lines).
void check_derivatives(Fmu& fmu, void* instance, const ForceTable& table, const double* point, const test::Sizes& sizes,
                       const std::vector<unsigned>& outputs) {
    const std::size_t n = table.axes().size();
    const unsigned inputs[4] = {0, 1, 2, 3};
    const double along[4] = {0.5, -2, 1, 1};
    std::vector<double> change(outputs.size()), wanted(outputs.size(), 0.0), size(outputs.size(), 0.0),
        at(outputs.size());
    const int status =
        fmu.call("fmi2GetDirectionalDerivative", instance, static_cast<const unsigned*>(outputs.data()), outputs.size(),
                 static_cast<const unsigned*>(inputs), n, static_cast<const double*>(along), change.data());
    const auto expected = test::expected(table, point);
    if (expected.refused) {
        ASSERT_EQ(status, discard);
        return;
    }
    ASSERT_EQ(status, ok);
    double slope = 0, rounding = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const auto& x = table.knots(k);
        const auto& axis = table.axes()[k];
        const bool at_end = axis.range == tables::RangePolicy::refuse && point[k] == axis.upper;
        auto above =
            at_end ? std::lower_bound(x.begin(), x.end(), point[k]) : std::upper_bound(x.begin(), x.end(), point[k]);
        above = std::clamp(above, x.begin() + 1, x.end() - 1);
        slope += along[k] * expected.at.slope[k];
        rounding += std::abs(along[k]) * (1e-12 * sizes.slope[k] + 1e-14 * sizes.value / (*above - *(above - 1)));
    }
    ASSERT_NEAR(change[0], slope, rounding);
    for (std::size_t k = 0; k < n; ++k) {
        const auto& x = table.knots(k);
        double low = point[k] < x.front() ? point[k] - (x.back() - x.front()) : x.back();
        double high = point[k] < x.front() ? x.front() : point[k] + (x.back() - x.front());
        for (std::size_t i = 0; i + 1 < x.size() && point[k] >= x.front() && point[k] < x.back(); ++i) {
            if (point[k] >= x[i] && point[k] < x[i + 1]) {
                low = x[i];
                high = x[i + 1];
            }
        }
        // Central differences are exact for the part that is cubic but for step^2; a place too near a line is passed
        // over.
        const double step = 1e-3 * (high - low);
        if (point[k] - 2 * step < low || point[k] + 2 * step > high || high - low < 1e-5 * (x.back() - x.front())) {
            return;
        }
        std::vector<double> moved(point, point + n);
        const double weights[4] = {1, -8, 8, -1}, places[4] = {-2, -1, 1, 2};
        for (std::size_t i = 0; i < 4; ++i) {
            moved[k] = point[k] + places[i] * step;
            ASSERT_EQ(fmu.call("fmi2SetReal", instance, static_cast<const unsigned*>(inputs), n,
                               static_cast<const double*>(moved.data())),
                      ok);
            const int got = fmu.call("fmi2GetReal", instance, static_cast<const unsigned*>(outputs.data()),
                                     outputs.size(), at.data());
            if (got != ok) {
                ASSERT_EQ(fmu.call("fmi2SetReal", instance, static_cast<const unsigned*>(inputs), n, point), ok);
                return;  // a neighbour is refused
            }
            for (std::size_t o = 0; o + 2 < outputs.size(); ++o) {
                wanted[o] += along[k] * weights[i] * at[o] / (12 * step);
                size[o] = std::max(size[o], std::abs(along[k] * at[o]) / step);
            }
        }
    }
    ASSERT_EQ(fmu.call("fmi2SetReal", instance, static_cast<const unsigned*>(inputs), n, point), ok);
    for (std::size_t o = 0; o < outputs.size(); ++o) {
        ASSERT_NEAR(change[o], wanted[o], 1e-11 * size[o]) << "output " << o << " of " << outputs.size();
    }
}

void check_values(Fmu& fmu, void* instance, const ForceTable& table, bool steps) {
    const std::size_t n = table.axes().size();
    const auto points = test::random_points(table, 10000);
    const test::Sizes sizes(table, points);
    const unsigned inputs[4] = {0, 1, 2, 3};
    std::vector<unsigned> outputs;
    for (unsigned k = 0; k < n + 4; ++k) {
        outputs.push_back(static_cast<unsigned>(n) + k);
    }
    std::vector<double> out(n + 4);
    for (std::size_t i = 0; i < 10000; ++i) {
        const double* point = &points[i * n];
        ASSERT_EQ(fmu.call("fmi2SetReal", instance, static_cast<const unsigned*>(inputs), n, point), ok);
        if (steps) {
            ASSERT_EQ(fmu.call("fmi2DoStep", instance, 0.1 * static_cast<double>(i), 0.1, 1), ok);
        }
        const auto e = test::expected(table, point);
        ASSERT_EQ(
            fmu.call("fmi2GetReal", instance, static_cast<const unsigned*>(outputs.data()), outputs.size(), out.data()),
            e.refused ? discard : ok);
        ASSERT_NO_FATAL_FAILURE(test::expect_alike(table, point, sizes, 1e-12, out[0], &out[1], out[1 + n],
                                                   out[2 + n] != 0, out[3 + n] != 0));
        if (i < 2000) {
            ASSERT_NO_FATAL_FAILURE(check_derivatives(fmu, instance, table, point, sizes, outputs)) << "point " << i;
        }
    }
    if (std::any_of(table.axes().begin(), table.axes().end(),
                    [](const auto& a) { return a.range == tables::RangePolicy::refuse; })) {
        // Whether it is outside can be asked at a point that is refused.
        const double outside[4] = {1e3, 1e3, 1e3, 1e3};
        ASSERT_EQ(fmu.call("fmi2SetReal", instance, static_cast<const unsigned*>(inputs), n,
                           static_cast<const double*>(outside)),
                  ok);
        ASSERT_EQ(fmu.call("fmi2GetReal", instance, static_cast<const unsigned*>(&outputs[n + 2]), std::size_t{1},
                           out.data()),
                  ok);
        EXPECT_EQ(out[0], 1);
    }
}

TEST(ExportsOfFmu, AreLoadedAndEvaluateLikeTheTable) {
    core::TemporaryFolder folder;
    int number = 0;
    for (const auto& table : test::tables_of_all_policies()) {
        const auto path = folder.path() / "lift.fmu";
        export_table(table, "fmu", path);
        const std::string first = core::read_file(path);
        export_table(table, "fmu", path);
        EXPECT_TRUE(first == core::read_file(path)) << "the same table must give the same bytes";
        if (test::have("python3")) {
            EXPECT_EQ(
                std::system(("python3 -c \"import zipfile,xml.dom.minidom as m;z=zipfile.ZipFile('" + path.string() +
                             "');assert z.testzip() is None;m.parseString(z.read('modelDescription.xml'))\"")
                                .c_str()),
                0);
        }
        const auto entries = unzipped(first);
        ASSERT_TRUE(entries.contains("modelDescription.xml"));
        ASSERT_TRUE(entries.contains("sources/fmu.c"));
        if (!entries.contains("binaries/linux64/lift.so")) {
            GTEST_SKIP() << "skipped: no C compiler, so the FMU has no binary";
        }
        const std::string& xml = entries.at("modelDescription.xml");
        EXPECT_THAT(xml, HasSubstr("Force table by Underbody: lift_force [N]"));
        EXPECT_THAT(xml, HasSubstr("Outside the range of gap"));
        EXPECT_THAT(xml, HasSubstr("name=\"lift_force_per_gap\""));
        EXPECT_THAT(xml, HasSubstr("name=\"lift_force_no_data\""));
        EXPECT_THAT(xml, HasSubstr("<Real unit=\"m\""));
        const std::size_t g = xml.find("guid=\"") + 6;
        const std::string guid = xml.substr(g, xml.find('"', g) - g);
        const auto library = folder.path() / ("lift" + std::to_string(number++) + ".so");
        core::write_file(library, entries.at("binaries/linux64/lift.so"));
        Fmu fmu(library);
        ASSERT_TRUE(fmu.loaded()) << ::dlerror();
        EXPECT_EQ(fmu.instantiate(1, "wrong"), nullptr);
        for (const int type : {0, 1}) {  // model exchange, co-simulation
            void* instance = fmu.instantiate(type, guid);
            ASSERT_NE(instance, nullptr);
            ASSERT_EQ(fmu.call("fmi2EnterInitializationMode", instance), ok);
            ASSERT_EQ(fmu.call("fmi2ExitInitializationMode", instance), ok);
            if (type == 0) {
                ASSERT_NO_FATAL_FAILURE(enter_continuous_time(fmu, instance));
            }
            ASSERT_NO_FATAL_FAILURE(check_values(fmu, instance, table, type == 1));
            fmu.free(instance);
        }
    }
}

TEST(ExportsOfFmu, GiveSeveralForces) {
    core::TemporaryFolder folder;
    const std::vector<ForceTable> both{test::sum_of_tables(), test::sum_of_tables("clamp", "side_force")};
    export_tables(both, "fmu", folder.path() / "body.fmu");
    const auto entries = unzipped(core::read_file(folder.path() / "body.fmu"));
    if (!entries.contains("binaries/linux64/body.so")) {
        GTEST_SKIP() << "skipped: no C compiler, so the FMU has no binary";
    }
    const std::string& xml = entries.at("modelDescription.xml");
    for (const char* name : {"lift_force", "side_force_per_pitch", "side_force_sigma", "outside", "no_data"}) {
        EXPECT_THAT(xml, HasSubstr("name=\"" + std::string(name) + "\""));
    }
    const std::size_t g = xml.find("guid=\"") + 6;
    core::write_file(folder.path() / "body.so", entries.at("binaries/linux64/body.so"));
    Fmu fmu(folder.path() / "body.so");
    ASSERT_TRUE(fmu.loaded()) << ::dlerror();
    void* instance = fmu.instantiate(1, xml.substr(g, xml.find('"', g) - g));
    ASSERT_NE(instance, nullptr);
    const auto points = test::random_points(both[0], 2000);
    const unsigned inputs[2] = {0, 1};
    unsigned outputs[10];
    std::iota(std::begin(outputs), std::end(outputs), 2U);
    for (std::size_t i = 0; i < points.size(); i += 2) {
        double out[10];
        ASSERT_EQ(fmu.call("fmi2SetReal", instance, static_cast<const unsigned*>(inputs), std::size_t{2},
                           static_cast<const double*>(&points[i])),
                  ok);
        ASSERT_EQ(fmu.call("fmi2GetReal", instance, static_cast<const unsigned*>(outputs), std::size_t{10},
                           static_cast<double*>(out)),
                  ok);
        for (std::size_t q = 0; q < 2; ++q) {
            static const test::Sizes sizes[2] = {{both[0], points}, {both[1], points}};
            ASSERT_NO_FATAL_FAILURE(test::expect_alike(both[q], &points[i], sizes[q], 1e-12, out[4 * q],
                                                       &out[4 * q + 1], out[4 * q + 3], out[8] != 0, out[9] != 0));
        }
    }
    fmu.free(instance);
}

TEST(ExportsOfFmu, RunUnderWindowsAsHere) {
    UNDERBODY_NEEDS_WINE();
    core::TemporaryFolder folder;
    const ForceTable table = test::sum_of_tables();
    export_table(table, "fmu", folder.path() / "lift.fmu");
    const std::string first = core::read_file(folder.path() / "lift.fmu");
    export_table(table, "fmu", folder.path() / "lift.fmu");
    EXPECT_TRUE(first == core::read_file(folder.path() / "lift.fmu")) << "the same table must give the same bytes";
    const auto entries = unzipped(first);
    ASSERT_TRUE(entries.contains("binaries/win64/lift.dll"));
    const std::string& xml = entries.at("modelDescription.xml");
    const std::size_t g = xml.find("guid=\"") + 6;
    const std::size_t n = table.axes().size();
    const auto points = test::random_points(table, 2000);
    std::string commands;
    for (std::size_t i = 0; i < 2000; ++i) {
        commands += "set " + std::to_string(n);
        for (std::size_t k = 0; k < n; ++k) {
            commands += " " + std::to_string(k) + " " + core::format_number(points[i * n + k]);
        }
        commands += "\nget " + std::to_string(n + 4);
        for (std::size_t k = 0; k < n + 4; ++k) {
            commands += " " + std::to_string(n + k);
        }
        commands += "\n";
    }
    const auto out =
        test::called_under_wine(entries.at("binaries/win64/lift.dll"), xml.substr(g, xml.find('"', g) - g), commands);
    ASSERT_EQ(out.size(), 2000 * (n + 4));
    const test::Sizes sizes(table, points);
    for (std::size_t i = 0; i < 2000; ++i) {
        const double* at = &out[i * (n + 4)];
        ASSERT_NO_FATAL_FAILURE(test::expect_alike(table, &points[i * n], sizes, 1e-12, at[0], at + 1, at[1 + n],
                                                   at[2 + n] != 0, at[3 + n] != 0));
    }
}

}  // namespace
}  // namespace underbody
