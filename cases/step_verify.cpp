// Our loads against the solver's own report of them.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "cases/engine.h"
#include "cases/excused.h"
#include "cases/percent.h"
#include "postproc/loads/deviation.h"
#include "postproc/loads/loads_case.h"

namespace underbody::cases {

namespace {

/// The rows of the loads that rows of the report are about: by file name first, else by all conditions they share.
class Rows {
public:
    Rows(const core::Table& loads, const core::Table& report) : loads_(loads), file_(report.find("file")) {
        const auto& names = loads.text("case");
        for (std::size_t i = 0; i < names.size(); ++i) {
            by_name_.emplace(names[i], i);
        }
        for (const auto& column : report.columns()) {
            const auto* mine = loads.find(column.name);
            if (mine != nullptr && !postproc::is_result(column.name)) {
                shared_.emplace_back(mine, &column);
                comparable_ = comparable_ && mine->is_text() == column.is_text();
            }
        }
        if (comparable_) {
            sort_by_most_different_numbers();
        }
    }

    [[nodiscard]] std::optional<std::size_t> find(std::size_t row) const {
        if (file_ != nullptr && file_->is_text()) {
            const auto found = by_name_.find(std::filesystem::path(file_->text[row]).stem().string());
            return found == by_name_.end() ? std::nullopt : std::optional<std::size_t>(found->second);
        }
        auto first = order_.begin();
        auto last = order_.end();
        if (sorted_ != nullptr) {
            const double wanted = sorted_->second->numbers[row];
            const auto below = [&](std::size_t i, double bound) { return sorted_->first->numbers[i] < bound; };
            first = std::lower_bound(first, last, wanted - slack(wanted), below);
            last = std::lower_bound(first, last, std::nextafter(wanted + slack(wanted), HUGE_VAL), below);
        }
        std::optional<std::size_t> best;
        for (; first != last; ++first) {
            if (fits(*first, row) && (!best || *first < *best)) {
                best = *first;
            }
        }
        return best;
    }

private:
    using Pair = std::pair<const core::Column*, const core::Column*>;  ///< of the loads, of the report

    static double slack(double value) { return 1e-6 * std::abs(value) + 1e-12; }

    [[nodiscard]] bool fits(std::size_t mine, std::size_t theirs) const {
        return std::all_of(shared_.begin(), shared_.end(), [&](const Pair& pair) {
            return pair.first->is_text() ? pair.first->text[mine] == pair.second->text[theirs]
                                         : std::abs(pair.first->numbers[mine] - pair.second->numbers[theirs]) <=
                                               slack(pair.second->numbers[theirs]);
        });
    }

    /// Of ten thousand cases few have the same value of the condition that varies most.
    void sort_by_most_different_numbers() {
        for (std::size_t i = 0; i < loads_.rows(); ++i) {
            order_.push_back(i);
        }
        std::size_t most = 0;
        for (const auto& pair : shared_) {
            if (pair.first->is_text() || std::any_of(pair.first->numbers.begin(), pair.first->numbers.end(),
                                                     [](double x) { return std::isnan(x); })) {
                continue;
            }
            const std::size_t different =
                std::set<double>(pair.first->numbers.begin(), pair.first->numbers.end()).size();
            if (different > most) {
                most = different;
                sorted_ = &pair;
            }
        }
        if (sorted_ != nullptr) {
            const auto& values = sorted_->first->numbers;
            std::stable_sort(order_.begin(), order_.end(),
                             [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
        }
    }

    const core::Table& loads_;
    const core::Column* file_;
    std::unordered_map<std::string, std::size_t> by_name_;
    std::vector<Pair> shared_;
    std::vector<std::size_t> order_;
    const Pair* sorted_ = nullptr;
    bool comparable_ = true;  ///< what is a text here is one there
};

/// Size of the force that a row of a table states, as far as it states its parts.
double resultant(const core::Table& table, std::size_t row) {
    return postproc::resultant([&](const char* name) {
        const auto* column = table.find(name);
        return column != nullptr ? column->numbers[row] : std::nan("");
    });
}

/// The values of a verification, one by one, and what they come to.
class Comparison {
public:
    Comparison(const VerifySpec& spec, const core::Table& loads, const core::Table& report)
        : spec_(spec), loads_(loads), report_(report) {}

    void take(std::size_t mine, std::size_t theirs, const postproc::LoadScale& scale) {
        for (const auto& quantity : spec_.quantities) {
            take(quantity, mine, theirs, scale);
        }
    }

    [[nodiscard]] nlohmann::json result() && {
        return {{"rows", std::move(rows_)},    {"worst", worst_},     {"worst_case", worst_case_},
                {"failed", failed_},           {"excused", excused_}, {"excused_worst", excused_worst_},
                {"tolerance", spec_.tolerance}};
    }

private:
    void take(const std::string& quantity, std::size_t mine, std::size_t row, const postproc::LoadScale& scale) {
        const double theirs = report_.numbers(quantity)[row];
        const double ours = loads_.numbers(quantity)[mine];
        const bool moment = quantity.ends_with("_moment");
        const double error = postproc::deviation(ours, theirs, moment, scale);
        const double size = postproc::load_measure(ours, theirs, moment, scale);
        // The field is the last iteration, the report the mean of many: what a run swings by is no error of ours.
        const auto* scatter = report_.find(quantity + "_scatter");
        const double swing =
            scatter != nullptr && std::isfinite(scatter->numbers[row]) ? 2 * scatter->numbers[row] / size : 0;
        const std::string& name = loads_.text("case")[mine];
        rows_.push_back({{"case", name},
                         {"quantity", quantity},
                         {"ours", ours},
                         {"solver", theirs},
                         {"error", error},
                         {"swing", swing}});
        const bool fails = !(error <= spec_.tolerance + swing);  // NaN fails too
        failed_ += fails ? 1 : 0;
        if (!fails && error > spec_.tolerance) {
            ++excused_;
            excused_worst_ = std::max(excused_worst_, error);
        }
        if (!(error - swing <= worst_)) {
            worst_ = error - swing;
            worst_case_ = name + ", " + quantity;
        }
    }

    const VerifySpec& spec_;
    const core::Table &loads_, &report_;
    nlohmann::json rows_ = nlohmann::json::array();
    double worst_ = 0;
    std::string worst_case_;
    std::size_t failed_ = 0, excused_ = 0;
    double excused_worst_ = 0;
};

nlohmann::json verify(const Engine& engine, const VerifySpec& spec, const core::Table& report) {
    const core::Table& loads = engine.results.loads;
    const auto* lengths = loads.find("reference_length");
    const Rows rows_of_loads(loads, report);
    std::unordered_set<std::string> chosen;
    for (const Case* entry : engine.study.select(spec.where)) {
        chosen.insert(entry->name);
    }
    Comparison comparison(spec, loads, report);
    for (std::size_t row = 0; row < report.rows(); ++row) {
        const auto mine = rows_of_loads.find(row);
        if (!mine || !chosen.contains(loads.text("case")[*mine])) {
            continue;
        }
        const double length =
            lengths != nullptr ? lengths->numbers[*mine] : engine.study.reference.number("length").value_or(1);
        comparison.take(*mine, row, postproc::load_scale(resultant(loads, *mine), resultant(report, row), length));
    }
    return std::move(comparison).result();
}

}  // namespace

std::string excused(const nlohmann::json& verification) {
    const auto count = verification.at("excused").get<std::size_t>();
    return count == 0 ? ""
                      : "; " + std::to_string(count) + " more off by up to " +
                            percent_of(verification.at("excused_worst").get<double>(), "the force's size") +
                            ", excused by what their own run swings by from iteration to iteration";
}

void run_verifications(Engine& engine) {
    for (const auto& spec : engine.study.verifications) {
        Key key("verify", {});
        key.add("table", engine.path_in_study(spec.table));
        key.add("loads", digest_of(engine.results.loads)).add("tolerance", spec.tolerance).add("where", spec.where);
        key.add("length", engine.study.reference.number("length").value_or(1));
        for (const auto& quantity : spec.quantities) {
            key.add("quantity", quantity);
        }
        for (const Case* entry : engine.study.select(spec.where)) {
            key.through("loads", entry->name);
        }
        const auto made = engine.make("verify", spec.name, key, [&] {
            const nlohmann::json document = verify(engine, spec, core::read_csv(spec.table));
            if (document.at("rows").empty()) {
                throw core::InputError("missing", "no row is about a case of this study",
                                       {spec.table.string(), {}, {}, {}});
            }
            return document.dump();
        });
        if (made) {
            const std::string text = engine.value(*made);
            engine.results.verifications.push_back(verify_result(spec.name, nlohmann::json::parse(text)));
            engine.add_document("verify/" + spec.name, text);
        }
    }
}

}  // namespace underbody::cases
