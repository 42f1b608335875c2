// What the benches of discovery share: options, the count of outcomes by kind and method, their print.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "tests/bench/discovery/peers.h"
#include "tests/bench/discovery/plants.h"
#include "tests/bench/discovery/score.h"

namespace underbody::bench {

struct Options {
    std::string family = "all", kind = "all", only;
    int seeds = 4;
    std::uint64_t first_seed = 1000;
    double level = 0;                  ///< 0: all levels
    double rate = 50;                  ///< Hz, of heave runs
    int coloured = -1, velocity = -1;  ///< -1: by seed
    int threads = 0;
    bool verbose = false, peers = true, markdown = false;
    std::string write;                        ///< folder that the data sets go to instead of to discover(); empty: none
    bool recalibrate = false;                 ///< once more with half and twice each number that decides a verdict
    std::map<std::string, double> constants;  ///< of those numbers, by name
};

/// Prints `usage` and leaves with exit code 2 where the command line is wrong.
Options read_options(int argc, char** argv, const char* usage);

class Campaign {
public:
    explicit Campaign(const Options& options) : options_(options) {}

    /// One data set of a kind ("single 1x", "clean", ...): discover() and what it scores, then `peers` by name where
    /// they were asked for. `fill` adds what only the bench knows: best reachable error, pull.
    void run(const std::string& kind, const Case& wanted, const dynamics::Model& model,
             double (*noise)(const Case&, const std::string& channel),
             const std::function<void(const Sample&, const dynamics::Measurements& all, const discovery::Discovery&,
                                      Outcome&)>& fill,
             const std::function<std::map<std::string, PeerAnswer>(const Sample&)>& peers);

    /// True where the options ask for such a case.
    [[nodiscard]] bool wants(const std::string& kind, const std::vector<std::string>& names, const std::string& law,
                             double level) const;

    /// All counts, calibration, coverage, time and memory; the table of the README with --markdown.
    void print() const;

    /// Of one kind, by discover() itself; empty where none was run.
    [[nodiscard]] Tally of(const std::string& kind) const { return tally(kind, "discover"); }
    [[nodiscard]] std::vector<std::string> kinds() const;

private:
    void print_markdown() const;
    [[nodiscard]] Tally tally(const std::string& kind, const std::string& method) const;
    const Options& options_;
    std::map<std::string, std::map<std::string, Tally>> tallies_;  ///< kind -> method
};

}  // namespace underbody::bench
