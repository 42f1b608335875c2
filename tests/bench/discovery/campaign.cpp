#include "tests/bench/discovery/campaign.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/parallel.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::bench {

namespace {

const char* const own_method = "discover";

void describe(const Case& wanted, const Outcome& one, const discovery::Discovery& found) {
    std::string said;
    for (const std::string& name : one.names) {
        said += name + " ";
    }
    for (const auto& [name, probability] : one.rivals) {
        if (probability > 0.005) {
            said += "| " + name + " " + std::to_string(probability).substr(0, 5) + " ";
        }
    }
    std::string on;
    for (const std::string& name : found.depends_on) {
        on += name + " ";
    }
    std::printf(
        "   %-60s -> %s %.3f %s gate %.2g: %s; dep %s; err %.2f -> %.2f (best %.2f, twins "
        "%.2f, noise %.3g %s, fresh %.2f) pull %.1f; %.1f s\n",
        wanted.text().c_str(), one.verdict.c_str(), one.stated, one.right_law() ? "right" : "wrong", found.gate,
        said.c_str(), on.c_str(), one.before, one.after, one.best, found.rest.twins / found.error.front().noise,
        found.error.front().noise, found.noise.empty() ? "" : found.noise.begin()->second.from.c_str(), one.fresh,
        one.pull, one.seconds);
    std::fflush(stdout);
}

/// The data set as a folder that `underbody discover` reads, with its truth beside it.
void write_set(const std::filesystem::path& folder, std::string kind, const Case& wanted, const Sample& sample,
               const dynamics::Model& model, const dynamics::Measurements& data) {
    std::replace_if(
        kind.begin(), kind.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '-');
    const std::filesystem::path own = folder / (kind + "-" + wanted.family + "-" + std::to_string(wanted.seed));
    std::filesystem::create_directories(own);
    dynamics::write_model(model, own / "model.toml");
    std::string text = "kind = \"" +
                       std::string(data.kind == dynamics::MeasurementKind::steady ? "static" : "time_series") +
                       "\"\n[noise]\n";
    for (const auto& [channel, noise] : data.noise) {
        text += channel + " = \"" + core::format_number(noise, 9) + " " + core::find_quantity(channel)->unit + "\"\n";
    }
    for (const dynamics::MeasuredRun& run : data.runs) {
        core::write_csv(own / (run.name + ".csv"), run.table);
        text += "[[run]]\nfile = \"" + run.name + ".csv\"\nuse = \"" +
                (run.use == dynamics::RunUse::test ? "test" : "train") + "\"\n";
    }
    core::write_file(own / "dataset.toml", text);
    const nlohmann::json truth{
        {"names", sample.names}, {"also", sample.also}, {"depends_on", sample.depends_on}, {"sub", kind}};
    core::write_file(own / "truth.json", truth.dump(1) + "\n");
}

Outcome peer_outcome(const PeerAnswer& answer, const Sample& sample, const std::string& channel, double noise) {
    Outcome one;
    one.truth = sample.names;
    one.also = sample.also;
    one.verdict = answer.verdict;
    one.names = answer.verdict == "unknown" ? std::vector<std::string>{"unknown"} : answer.names;
    std::vector<std::string> truth = sample.depends_on, said = answer.depends_on;
    std::sort(truth.begin(), truth.end());
    std::sort(said.begin(), said.end());
    one.variables = truth == said;
    one.after = answer.rmse.at(channel) / noise;
    return one;
}

}  // namespace

Options read_options(int argc, char** argv, const char* usage) {
    Options o;
    for (int i = 1; i < argc; ++i) {
        const auto value = [&](const char* key) { return std::strcmp(argv[i], key) == 0 && i + 1 < argc; };
        if (value("--family"))
            o.family = argv[++i];
        else if (value("--kind"))
            o.kind = argv[++i];
        else if (value("--only"))
            o.only = argv[++i];
        else if (value("--seeds"))
            o.seeds = std::atoi(argv[++i]);
        else if (value("--first-seed"))
            o.first_seed = static_cast<std::uint64_t>(std::atoll(argv[++i]));
        else if (value("--level"))
            o.level = std::atof(argv[++i]);
        else if (value("--write"))
            o.write = argv[++i];
        else if (value("--rate"))
            o.rate = std::atof(argv[++i]);
        else if (value("--coloured"))
            o.coloured = std::atoi(argv[++i]);
        else if (value("--velocity"))
            o.velocity = std::atoi(argv[++i]);
        else if (value("--threads"))
            o.threads = std::atoi(argv[++i]);
        else if (std::strcmp(argv[i], "--verbose") == 0)
            o.verbose = true;
        else if (std::strcmp(argv[i], "--markdown") == 0)
            o.markdown = true;
        else if (std::strcmp(argv[i], "--recalibrate") == 0)
            o.recalibrate = true;
        else if (std::strcmp(argv[i], "--no-peers") == 0)
            o.peers = false;
        else {
            std::printf("%s", usage);
            std::exit(2);
        }
    }
    core::set_threads(o.threads);
    return o;
}

bool Campaign::wants(const std::string& kind, const std::vector<std::string>& names, const std::string& law,
                     double level) const {
    const std::string word = kind.substr(0, kind.find(' '));
    if (options_.kind != "all" && options_.kind != word && options_.kind != kind) {
        return false;
    }
    if (!options_.only.empty() && std::find(names.begin(), names.end(), options_.only) == names.end() &&
        law != options_.only) {
        return false;
    }
    return options_.level <= 0 || level == options_.level;
}

void Campaign::run(const std::string& kind, const Case& wanted, const dynamics::Model& model,
                   double (*noise_of)(const Case&, const std::string&),
                   const std::function<void(const Sample&, const dynamics::Measurements&, const discovery::Discovery&,
                                            Outcome&)>& fill,
                   const std::function<std::map<std::string, PeerAnswer>(const Sample&)>& peers) {
    const Sample sample = make_sample(wanted);
    dynamics::Measurements data = sample.train;
    data.runs.insert(data.runs.end(), sample.test.runs.begin(), sample.test.runs.end());
    if (!options_.write.empty()) {
        write_set(std::filesystem::path(options_.write), kind, wanted, sample, model, data);
        return;
    }
    discovery::DiscoverOptions settings;
    settings.figures = settings.consequence = false;
    settings.constants = options_.constants;
    const std::clock_t begin = std::clock();
    const discovery::Discovery found = discovery::discover(model, data, settings);
    Outcome one = outcome_of(found, sample.names, sample.depends_on);
    one.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;  // of all threads: fair on a busy machine
    one.also = sample.also;
    const std::string channel = found.error.front().channel;
    const double noise = noise_of(wanted, channel);
    one.before = found.error.front().before.rmse / noise;
    one.after = found.error.front().after.rmse / noise;
    if (!sample.fresh.runs.empty()) {
        const auto error = [&](const dynamics::Model& with) {
            return dynamics::predict(with, sample.fresh).channels.front().rmse;
        };
        one.fresh = error(found.model) / error(model);
    }
    fill(sample, data, found, one);
    if (options_.verbose || (!one.right() && !one.tied()) || one.after > 1.15 * one.best || one.fresh > 1.05) {
        describe(wanted, one, found);
    }
    const std::string own =
        wanted.family + "   " + (wanted.names.empty() ? "clean" : wanted.names.front()) + " " + wanted.law;
    for (const std::string& key : {kind, wanted.family + " " + kind, own}) {
        tallies_[key][own_method].outcomes.push_back(one);
    }
    if (options_.peers) {
        for (const auto& [name, answer] : peers(sample)) {
            Outcome other = peer_outcome(answer, sample, channel, noise);
            other.before = one.before;
            other.best = one.best;
            tallies_[kind][name].outcomes.push_back(other);
        }
    }
}

Tally Campaign::tally(const std::string& kind, const std::string& method) const {
    const auto found = tallies_.find(kind);
    return found == tallies_.end() || found->second.count(method) == 0 ? Tally{} : found->second.at(method);
}

std::vector<std::string> Campaign::kinds() const {
    std::vector<std::string> list;
    for (const auto& [kind, methods] : tallies_) {
        if (kind.find("   ") == std::string::npos && kind.find(' ') != std::string::npos) {
            list.push_back(kind);
        }
    }
    return list;
}

void Campaign::print_markdown() const {
    std::printf(
        "\n| method | one effect at 1x: named (wrong) | at 2x: named (wrong) | clean: false | outside the catalogue: "
        "said so, with its variables | held-out error over the best "
        "reachable, 2x |\n|---|---|---|---|---|---|\n");
    for (const char* method :
         {own_method, "sparse regression (STLSQ)", "polynomial residual", "Gaussian-process discrepancy"}) {
        const auto named = [](const Tally& t) {
            return share(t.count([](const Outcome& o) { return o.right() || o.tied(); }), t.count()) + ", " +
                   std::to_string(t.count([](const Outcome& o) { return o.wrong(); })) + " wrong";
        };
        const Tally clean = tally("clean", method), unknown = tally("unknown", method),
                    strong = tally("single 2x", method);
        std::printf(
            "| %s | %s | %s | %s | %s | %.2f |\n", method, named(tally("single 1x", method)).c_str(),
            named(strong).c_str(),
            share(clean.count([](const Outcome& o) { return !o.right(); }), clean.count()).c_str(),
            share(unknown.count([](const Outcome& o) { return o.right() && o.variables; }), unknown.count()).c_str(),
            strong.oracle_gap());
    }
}

void Campaign::print() const {
    std::printf("\n");
    std::vector<Outcome> all;
    double longest = 0;
    for (const auto& [kind, methods] : tallies_) {
        for (const auto& [method, tally] : methods) {
            std::printf("%-40s %-28s %s\n", kind.c_str(), method.c_str(), tally.line().c_str());
            if (const std::string fresh = tally.fresh_line(); !fresh.empty()) {
                std::printf("%-40s %-28s %s\n", "", "", fresh.c_str());
            }
        }
        if (kind.find("   ") != std::string::npos) {  // each data set stands in one of these
            const auto& outcomes = methods.at(own_method).outcomes;
            all.insert(all.end(), outcomes.begin(), outcomes.end());
        }
    }
    for (const Outcome& one : all) {
        longest = std::max(longest, one.seconds);
    }
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    std::printf("\n%s%s%zu data sets; longest verdict %.1f s of all threads; most memory the process held %.0f MB\n",
                calibration_lines(all).c_str(), coverage_line(all).c_str(), all.size(), longest,
                static_cast<double>(used.ru_maxrss) / 1024);
    if (options_.markdown) {
        print_markdown();
    }
}

}  // namespace underbody::bench
