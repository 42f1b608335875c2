// How often the errors that a table states hold the truth: known forces measured at random places with noise, over many
// random forces of a kind.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/random.h"
#include "core/table.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::test {

/// A kind of force (random numbers of one case come from `random`), points of it, and their noise.
struct Setting {
    std::string name;
    std::size_t axes = 1;
    std::vector<std::size_t> grid;  ///< set points an axis; empty: `points` at random places
    std::size_t points = 0;
    double noise = 0;       ///< standard deviation, in shares of the force's
    bool relative = false;  ///< ... or of its own value there (and a tenth of the spread)
    bool stated = true;     ///< the points carry their errors
    double ratio = 20;      ///< of the largest to the smallest gap
    enum class Kind { film, dip, smooth } kind = Kind::dip;
    std::size_t seeds = 40;  ///< cases of a run that is not a short one
};

/// Force against gap over its smallest value (1 to ratio), pitch (-1 to 1) and speed (0.4 to 1); about unit size over
/// the points.
class KnownForce {
public:
    KnownForce(const Setting& setting, core::Random& random) : setting_(setting) {
        for (double& c : c_) {
            c = random.uniform();
        }
        std::vector<double> values;
        for (int i = 0; i < 200; ++i) {
            std::array<double, 3> at = place(random);
            values.push_back(raw(at.data()));
        }
        double mean = 0, square = 0;
        for (const double v : values) {
            mean += v / 200;
        }
        for (const double v : values) {
            square += (v - mean) * (v - mean) / 200;
        }
        size_ = std::sqrt(square);
    }
    /// A random place inside the ranges, small gaps as likely as large ones.
    [[nodiscard]] std::array<double, 3> place(core::Random& random) const {
        return {std::pow(setting_.ratio, random.uniform()), random.uniform(-1, 1), random.uniform(0.4, 1)};
    }
    [[nodiscard]] double operator()(const double* x) const { return raw(x) / size_; }

private:
    [[nodiscard]] double raw(const double* x) const {
        const double h = x[0];
        double force = 0;
        if (setting_.kind == Setting::Kind::film) {  // 1/h^2 over a small free-stream part
            force = (0.6 + 0.8 * c_[0]) / (h * h) + (c_[1] - 0.5) / h + 0.1 * c_[2];
        } else if (setting_.kind ==
                   Setting::Kind::dip) {  // repulsion of the film, suction further out, and what is left far away
            const double at = std::log(2 + 6 * c_[0]), width = 0.5 + 0.5 * c_[1];
            force =
                (0.5 + c_[2]) / h - (0.5 + c_[3]) * std::exp(-std::pow((std::log(h) - at) / width, 2)) + 0.2 * c_[4];
        } else {
            force = c_[0] + c_[1] * std::log(h) + (c_[2] - 0.5) * std::sin((1 + c_[3]) * std::log(h) + 6 * c_[4]);
        }
        if (setting_.axes > 1) {
            force += (0.5 + c_[5]) * x[1] / (1 + 0.3 * h) + (c_[6] - 0.5) * x[1] * x[1] +
                     0.3 * std::sin(2 * c_[7] * x[1] + std::log(h));
        }
        return setting_.axes > 2 ? force * std::pow(x[2], 1.9 + 0.2 * c_[8]) : force;
    }
    const Setting& setting_;
    std::array<double, 9> c_{};
    double size_ = 1;
};

/// Points of a known force as a table: gap in mm, pitch in rad, speed in m/s.
inline core::Table measured(const Setting& setting, const KnownForce& force, core::Random& random) {
    std::vector<std::array<double, 3>> at;
    if (setting.grid.empty()) {
        for (std::size_t i = 0; i < setting.points; ++i) {
            at.push_back(force.place(random));
        }
    } else {
        std::vector<std::vector<double>> lines(setting.axes);
        for (std::size_t k = 0; k < setting.axes; ++k) {
            const std::size_t n = setting.grid[k];
            for (std::size_t i = 0; i < n; ++i) {
                // Not quite even, as people choose them.
                const double t = (static_cast<double>(i) + (i > 0 && i + 1 < n ? random.uniform(-0.25, 0.25) : 0)) /
                                 static_cast<double>(n - 1);
                lines[k].push_back(k == 0 ? std::pow(setting.ratio, t) : k == 1 ? 2 * t - 1 : 0.4 + 0.6 * t);
            }
        }
        std::size_t count = 1;
        for (const auto& line : lines) {
            count *= line.size();
        }
        for (std::size_t i = 0; i < count; ++i) {
            std::array<double, 3> x{1, 0, 1};
            std::size_t rest = i;
            for (std::size_t k = setting.axes; k-- > 0;) {
                x[k] = lines[k][rest % lines[k].size()];
                rest /= lines[k].size();
            }
            at.push_back(x);
        }
    }
    std::array<std::vector<double>, 3> columns;
    std::vector<double> value, sigma;
    for (const auto& x : at) {
        for (std::size_t k = 0; k < 3; ++k) {
            columns[k].push_back(k == 0 ? 1e-3 * x[k] : x[k]);
        }
        const double f = force(x.data());
        sigma.push_back(setting.noise * (setting.relative ? std::abs(f) + 0.1 : 1));
        value.push_back(f + random.normal(0, sigma.back()));
    }
    core::Table table;
    table.source = setting.name;
    const char* names[] = {"gap", "pitch", "speed"};
    const char* units[] = {"m", "rad", "m/s"};
    for (std::size_t k = 0; k < setting.axes; ++k) {
        table.add_numbers(names[k], units[k], columns[k]);
    }
    table.add_numbers("lift_force", "N", value);
    if (setting.stated && setting.noise > 0) {
        table.add_numbers("lift_force_sigma", "N", sigma);
    }
    return table;
}

/// What came of a setting.
struct Calibration {
    double share = 0;      ///< of the places where the truth lies within one stated standard deviation
    double share_two = 0;  ///< within two
    double scale = 0;      ///< factor on the stated bands that makes them hold 68 %
    double width = 0;  ///< mean stated standard deviation over the mean of the narrowest bands that hold 68 %, one in
                       ///< each tenth of the gaps
    double error = 0;  ///< root mean square miss
};

/// `places` random places inside the points of each of `seeds` cases.
inline Calibration calibration(const Setting& setting, std::uint64_t first_seed, std::size_t seeds,
                               const tables::FitOptions& options = {}, int places = 60) {
    struct Miss {
        double size, sigma;
    };
    std::array<std::vector<Miss>, 10> bins;
    for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
        core::Random random(77001, seed);
        const KnownForce force(setting, random);
        const auto table = tables::ForceTable::fit(measured(setting, force, random), "lift_force", options);
        const auto& axes = table.axes();
        for (int i = 0; i < places; ++i) {
            auto x = force.place(random);
            std::array<double, 3> at{1e-3 * x[0], x[1], x[2]};
            bool inside = true;
            for (std::size_t k = 0; k < axes.size(); ++k) {
                inside = inside && at[k] >= axes[k].lower && at[k] <= axes[k].upper;
            }
            if (!inside) {
                continue;
            }
            const auto e = table.at({at.data(), axes.size()});
            const auto bin = static_cast<std::size_t>(std::log(x[0]) / std::log(setting.ratio) * 9.999);
            bins[bin].push_back({std::abs(e.value - force(x.data())), e.sigma});
        }
    }
    Calibration result;
    std::vector<double> ratios;
    double count = 0, narrowest = 0, stated = 0;
    for (auto& bin : bins) {
        if (bin.empty()) {
            continue;
        }
        for (const Miss& m : bin) {
            result.share += m.size <= m.sigma ? 1 : 0;
            result.share_two += m.size <= 2 * m.sigma ? 1 : 0;
            result.error += m.size * m.size;
            stated += m.sigma;
            ratios.push_back(m.size / m.sigma);
        }
        std::sort(bin.begin(), bin.end(), [](const Miss& a, const Miss& b) { return a.size < b.size; });
        narrowest += bin[static_cast<std::size_t>(0.6827 * static_cast<double>(bin.size()))].size *
                     static_cast<double>(bin.size());
        count += static_cast<double>(bin.size());
    }
    std::sort(ratios.begin(), ratios.end());
    result.scale = ratios[static_cast<std::size_t>(0.6827 * count)];
    result.share /= count;
    result.share_two /= count;
    result.error = std::sqrt(result.error / count);
    result.width = stated / narrowest;
    return result;
}

inline std::vector<Setting> settings() {
    using Kind = Setting::Kind;
    std::vector<Setting> all;
    const auto add = [&](std::string name, std::size_t axes, std::vector<std::size_t> grid, std::size_t points,
                         double noise, bool relative, bool stated, double ratio, Kind kind, std::size_t seeds) {
        all.push_back({std::move(name), axes, std::move(grid), points, noise, relative, stated, ratio, kind, seeds});
    };
    add("film, 10 points, 1 % stated", 1, {10}, 0, 0.01, true, true, 20, Kind::film, 60);
    add("film, 10 points, 3 % stated", 1, {10}, 0, 0.03, true, true, 20, Kind::film, 60);
    add("film, 10 points, 10 % stated", 1, {10}, 0, 0.10, true, true, 20, Kind::film, 60);
    add("film, 10 points, exact", 1, {10}, 0, 0, false, false, 20, Kind::film, 60);
    add("film, 10 points, 3 % unstated", 1, {10}, 0, 0.03, true, false, 20, Kind::film, 60);
    add("dip, 8 points, 3 % stated", 1, {8}, 0, 0.03, false, true, 50, Kind::dip, 60);
    add("dip, 12 points, 3 % stated", 1, {12}, 0, 0.03, false, true, 50, Kind::dip, 60);
    add("dip, 12 points, 10 % stated", 1, {12}, 0, 0.10, false, true, 50, Kind::dip, 60);
    add("dip, 12 points, exact", 1, {12}, 0, 0, false, false, 50, Kind::dip, 60);
    add("dip, 15 points, 5 % unstated", 1, {15}, 0, 0.05, false, false, 50, Kind::dip, 60);
    add("dip, 25 points, 3 % stated", 1, {25}, 0, 0.03, false, true, 50, Kind::dip, 60);
    add("dip, 25 points, 10 % unstated", 1, {25}, 0, 0.10, false, false, 50, Kind::dip, 60);
    add("dip, 20 points, 3 % stated", 1, {20}, 0, 0.03, false, true, 50, Kind::dip, 60);
    add("film, 20 points, 3 % stated", 1, {20}, 0, 0.03, true, true, 20, Kind::film, 60);
    add("smooth, 10 points, 3 % stated", 1, {10}, 0, 0.03, false, true, 20, Kind::smooth, 60);
    add("2-D, 20 scattered, 3 % stated", 2, {}, 20, 0.03, false, true, 20, Kind::dip, 30);
    add("2-D, 40 scattered, 3 % stated", 2, {}, 40, 0.03, false, true, 20, Kind::dip, 30);
    add("2-D, 40 scattered, 10 % stated", 2, {}, 40, 0.10, false, true, 20, Kind::dip, 30);
    add("2-D, 40 scattered, 3 % unstated", 2, {}, 40, 0.03, false, false, 20, Kind::dip, 30);
    add("2-D, 8 x 5 grid, 3 % stated", 2, {8, 5}, 0, 0.03, false, true, 20, Kind::dip, 30);
    add("2-D, 8 x 5 grid, exact", 2, {8, 5}, 0, 0, false, false, 20, Kind::dip, 30);
    add("2-D film, 8 x 5 grid, exact", 2, {8, 5}, 0, 0, false, false, 20, Kind::film, 30);
    add("2-D, 40 scattered, exact", 2, {}, 40, 0, false, false, 20, Kind::dip, 30);
    add("2-D film, 25 scattered, exact", 2, {}, 25, 0, true, false, 20, Kind::film, 30);
    add("2-D film, 25 scattered, 3 % stated", 2, {}, 25, 0.03, true, true, 20, Kind::film, 30);
    add("3-D, 40 scattered, 3 % stated", 3, {}, 40, 0.03, false, true, 20, Kind::dip, 12);
    add("3-D, 80 scattered, 3 % stated", 3, {}, 80, 0.03, false, true, 20, Kind::dip, 12);
    add("3-D, 60 scattered, 10 % stated", 3, {}, 60, 0.10, false, true, 20, Kind::dip, 12);
    add("3-D, 60 scattered, 3 % unstated", 3, {}, 60, 0.03, false, false, 20, Kind::dip, 12);
    add("3-D, 6 x 4 x 3 grid, 3 % stated", 3, {6, 4, 3}, 0, 0.03, false, true, 20, Kind::dip, 12);
    return all;
}

}  // namespace underbody::test
