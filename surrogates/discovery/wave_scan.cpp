#include "surrogates/discovery/wave_scan.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace underbody::discovery {

namespace {

constexpr double highest_frequency = 4;  ///< Hz, of a periodic force that gap readings can show
constexpr double two_pi = 2 * std::numbers::pi;

/// Peaks of the innovations' own periodogram: a line in the force is one in them too, as narrow as the runs are long.
std::vector<double> peaks_of(const std::vector<SampledRun>& runs, const std::vector<double>& innovations,
                             std::size_t count) {
    constexpr std::size_t most = 4000;
    const double first = lowest_frequency(runs);
    const double step = std::max(0.125 * first, (highest_frequency - first) / static_cast<double>(most));
    std::vector<double> power;
    for (double frequency = first; frequency < highest_frequency; frequency += step) {
        std::vector<std::complex<double>> sum(runs.front().channels);
        for (const SampledRun& run : runs) {
            for (std::size_t k = 0; k < run.time.size(); ++k) {
                const double angle = two_pi * frequency * run.time[k];
                const std::complex<double> turn(std::cos(angle), std::sin(angle));
                for (std::size_t c = 0; c < std::min(sum.size(), run.channels); ++c) {
                    sum[c] += turn * innovations[run.begin + run.channels * k + c];
                }
            }
        }
        power.push_back(0);
        for (const std::complex<double>& one : sum) {
            power.back() += std::norm(one);
        }
    }
    std::vector<std::size_t> peaks;
    for (std::size_t k = 0; k < power.size(); ++k) {
        if ((k == 0 || power[k] >= power[k - 1]) && (k + 1 == power.size() || power[k] > power[k + 1])) {
            peaks.push_back(k);
        }
    }
    std::sort(peaks.begin(), peaks.end(), [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
    std::vector<double> frequencies;
    for (std::size_t k = 0; k < std::min(count, peaks.size()); ++k) {
        frequencies.push_back(first + step * static_cast<double>(peaks[k]));
    }
    return frequencies;
}

}  // namespace

WaveLine wave_line(double frequency, const std::vector<double>& sine, const std::vector<double>& cosine,
                   const std::vector<double>& innovations) {
    double ss = 0, sc = 0, cc = 0, s = 0, c = 0;
    for (std::size_t i = 0; i < innovations.size(); ++i) {
        ss += sine[i] * sine[i];
        sc += sine[i] * cosine[i];
        cc += cosine[i] * cosine[i];
        s += sine[i] * innovations[i];
        c += cosine[i] * innovations[i];
    }
    const double determinant = ss * cc - sc * sc;
    if (!(determinant > 1e-12 * ss * cc)) {
        return {frequency, 0, 0, 0};
    }
    const double a = (cc * s - sc * c) / determinant;  // of the sine
    const double b = (ss * c - sc * s) / determinant;  // of the cosine
    return {frequency, a * s + b * c, std::hypot(a, b), std::atan2(b, a)};
}

double lowest_frequency(const std::vector<SampledRun>& runs) {
    double longest = 1e-3;
    for (const SampledRun& run : runs) {
        longest = std::max(longest, run.time.back() - run.time.front());
    }
    return 2 / longest;
}

std::vector<std::vector<double>> wave_starts(const std::vector<SampledRun>& runs,
                                             const std::vector<double>& innovations,
                                             const std::function<WaveLine(double)>& line_at, std::size_t count) {
    const double lowest = lowest_frequency(runs);
    // slow waves are bent by the filter and the motion, each run its own way: they are asked one by one
    std::vector<double> frequencies;
    for (double frequency = lowest; frequency < 6 * lowest && frequency < highest_frequency; frequency *= 1.06) {
        frequencies.push_back(frequency);
    }
    for (const double frequency : peaks_of(runs, innovations, 12)) {
        frequencies.push_back(frequency);
    }
    std::vector<WaveLine> lines;
    for (const double frequency : frequencies) {
        lines.push_back(line_at(frequency));
    }
    std::sort(lines.begin(), lines.end(), [](const WaveLine& a, const WaveLine& b) { return a.gain > b.gain; });
    std::vector<std::vector<double>> starts;
    std::vector<double> taken;
    for (const WaveLine& line : lines) {
        const bool near = std::any_of(taken.begin(), taken.end(),
                                      [&](double f) { return std::abs(line.frequency - f) < 0.4 * lowest; });
        if (!near && starts.size() < count) {
            starts.push_back({std::clamp(line.amplitude, 1e-4, 1.0), line.frequency, line.phase});
            taken.push_back(line.frequency);
        }
    }
    return starts;
}

void begin_scanned(std::vector<Hypothesis>& list, const std::function<std::vector<std::vector<double>>()>& starts) {
    for (Hypothesis& candidate : list) {
        if (is_scanned(candidate)) {
            candidate.starts = starts();
            std::erase_if(candidate.starts,
                          [&](const std::vector<double>& start) { return start[1] < candidate.parameters[1].lower; });
        }
    }
    std::erase_if(list, [](const Hypothesis& h) { return is_scanned(h) && h.starts.empty(); });
}

}  // namespace underbody::discovery
