#include "postproc/loads/settled.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/text.h"
#include "postproc/field/beside.h"
#include "postproc/field/vector_math.h"
#include "postproc/importers/reports/reports.h"
#include "postproc/loads/stated_parts.h"

namespace underbody::postproc {

namespace fs = std::filesystem;

namespace {

std::string percent(double share) { return core::format_number(100 * share, 3) + " %"; }

/// A monitor's column by its name, or its file's: "lift", "report-drag", "cl-rfile". Names that say no more than
/// "moment" or "cm" may be about any axis.
std::string quantity_named(const std::string& name) {
    const std::string plain = core::lower_case(name);
    std::vector<std::string> words(1);
    for (const char c : plain) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
            words.back() += c;
        } else if (!words.back().empty()) {
            words.emplace_back();
        }
    }
    const auto has = [&](std::initializer_list<const char*> known) {
        return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
            return std::find(known.begin(), known.end(), word) != known.end();
        });
    };
    const std::vector<std::pair<std::string, bool>> found = {{"lift_force", has({"lift", "cl"})},
                                                             {"drag_force", has({"drag", "cd"})},
                                                             {"side_force", has({"side"})},
                                                             {"pitch_moment", has({"pitch", "pitching"})},
                                                             {"roll_moment", has({"roll", "rolling"})},
                                                             {"yaw_moment", has({"yaw", "yawing"})}};
    std::string quantity;
    for (const auto& [one, is] : found) {
        if (is && !quantity.empty()) {
            return {};
        }
        quantity = is ? one : quantity;
    }
    return quantity;
}

bool counts_time(const Monitor& monitor) {
    return std::any_of(monitor.columns.begin(), monitor.columns.end(), [](const std::string& name) {
        const std::string plain = core::lower_case(name);
        return plain == "time" || plain == "flow-time" || plain == "time-step" || plain == "time step" ||
               plain.starts_with("time [");
    });
}

/// Rows up to the field's time, where the monitor's first column or a column of times reaches it; else all.
std::size_t rows_of_field(const Monitor& monitor, const LoadsResult& result) {
    const std::size_t rows = monitor.values.front().size();
    if (!result.time || rows == 0) {
        return rows;
    }
    const auto flow_time = std::find(monitor.columns.begin(), monitor.columns.end(), "flow-time");
    const auto& clock = flow_time != monitor.columns.end()
                            ? monitor.values[static_cast<std::size_t>(flow_time - monitor.columns.begin())]
                            : monitor.values.front();
    const std::size_t row = nearest_row(clock, *result.time);
    const bool there =
        std::abs(clock[row] - *result.time) <= 1e-5 * std::max(std::abs(clock[row]), std::abs(*result.time));
    return there && row + 1 >= shortest_history ? row + 1 : rows;
}

double load_of(const LoadsResult& result, const std::string& quantity) {
    const auto row = table_row(result);
    const auto found =
        std::find_if(row.begin(), row.end(), [&](const LoadsColumn& column) { return column.name == quantity; });
    return found == row.end() ? 0 : found->value;
}

class Judge {
public:
    Judge(const LoadsResult& result, core::Problems& notes) : result_(result), notes_(notes) {
        const auto& named = result.named;
        force_ = norm(result.total.force);
    }

    void take(const std::vector<StatedLoad>& stated) {
        for (const auto& [name, sigma] : iteration_sigmas(result_, stated)) {
            const std::string& quantity = name;  // clang 14 takes no name of a pair into the lambda
            const auto load = std::find_if(stated.rbegin(), stated.rend(), [&](const StatedLoad& one) {
                const bool whole = one.zones.empty() || one.zones.size() >= result_.zones.size();
                return one.quantity == quantity && one.part == LoadPart::total && one.history && whole;
            });
            if (load != stated.rend()) {
                settled_.loads.push_back({quantity, load->file, *load->history, sigma});
                files_.insert(load->file);
            }
        }
    }

    void read(const fs::path& file) {
        if (files_.contains(file.string())) {
            return;
        }
        Monitor monitor;
        try {
            if (!report_kinds(file).monitor) {
                return;
            }
            monitor = read_monitor(file);
        } catch (const core::InputError& error) {
            notes_.push_back({core::Problem::Severity::note,
                              std::string("not used for the verdict on the solution: ") + error.message(),
                              {file.string(), {}, {}, {}}});
            return;
        }
        settled_.transient = settled_.transient || counts_time(monitor);
        const std::size_t rows = rows_of_field(monitor, result_);
        if (monitor.title == "residuals") {
            take_residuals(monitor, rows);
        } else {
            take_loads(monitor, rows);
        }
    }

    Settled verdict() {
        std::vector<std::string> faults = not_finite_;
        find_units_of_swings();
        for (auto& load : settled_.loads) {
            const double of_load = scale_of(load);
            load.fault = of_load > 0 ? fault_of(load.scatter, of_load, settled_.transient) : "";
            if (!load.fault.empty()) {
                faults.push_back(load.quantity + " " + load.fault);
            }
        }
        const auto high = highest_residual();
        const bool loads_known = !settled_.loads.empty();
        if (high && (!std::isfinite(high->last) ||
                     high->last > (loads_known || settled_.transient ? unsettled_residual : settled_residual))) {
            faults.push_back("the residual of " + high->equation + " is " + core::format_number(high->last, 3));
        }
        if (!faults.empty()) {
            settled_.verdict = SettledVerdict::not_settled;
            for (const auto& fault : faults) {
                settled_.why += (settled_.why.empty() ? "" : "; ") + fault;
            }
        } else if (loads_known) {
            settled_.verdict = SettledVerdict::settled;
            settled_.why =
                settled_loads() + (high ? ", residuals at " + core::format_number(high->last, 2) + " or below" : "");
        } else if (high && !settled_.transient) {
            settled_.verdict = SettledVerdict::settled;
            settled_.why = "residuals at " + core::format_number(high->last, 2) +
                           " or below; no history of a load: its scatter is not known";
        } else {
            settled_.why = !without_unit_.empty()
                               ? without_unit_ + " swings about zero in a unit that nothing beside the file states"
                           : short_ ? "the histories beside the file are too short to judge"
                                    : "no history of a load and no residuals beside the file";
        }
        return std::move(settled_);
    }

private:
    void take_residuals(const Monitor& monitor, std::size_t rows) {
        for (std::size_t c = 1; c < monitor.columns.size(); ++c) {
            if (monitor.columns[c].ends_with(" max")) {
                continue;  // CFX's largest one beside its RMS
            }
            double largest = 0;
            double last = std::nan("");
            bool seen = false;
            for (std::size_t i = 0; i < rows; ++i) {
                const double value = monitor.values[c][i];
                largest = std::isfinite(value) ? std::max(largest, value) : largest;
                last = std::isnan(value) && i + 1 < rows ? last : value;
                seen = seen || std::isfinite(value);
            }
            if (seen) {
                settled_.residuals.push_back(
                    {monitor.columns[c], last, last > 0 && largest > 0 ? std::log10(largest / last) : 0, monitor.file});
            }
        }
        short_ = short_ || settled_.residuals.empty();
    }

    void take_loads(const Monitor& monitor, std::size_t rows) {
        for (std::size_t c = 1; c < monitor.columns.size(); ++c) {
            std::string quantity = quantity_named(monitor.columns[c]);
            if (quantity.empty() && monitor.columns.size() == 2) {
                quantity =
                    quantity_named(monitor.title.empty() ? fs::path(monitor.file).stem().string() : monitor.title);
            }
            const bool known = std::any_of(settled_.loads.begin(), settled_.loads.end(),
                                           [&](const LoadHistory& load) { return load.quantity == quantity; });
            if (quantity.empty() || known) {
                continue;
            }
            const std::span<const double> history(monitor.values[c].data(), rows);
            if (rows > 0 && !std::isfinite(history.back())) {
                not_finite_.push_back("the monitor of " + quantity + " is not finite at its end");
                continue;
            }
            if (rows < shortest_history ||
                std::any_of(history.begin(), history.end(), [](double x) { return !std::isfinite(x); })) {
                short_ = true;
                continue;
            }
            LoadHistory load{quantity, monitor.file, iteration_scatter(history), 0};
            // A coefficient, half a body, another sign: what is common to all is the share of the mean. One that
            // swings about zero has none: its value at the field's time says what its unit is.
            const double own = std::abs(load_of(result_, quantity)), mean = std::abs(load.scatter.mean);
            const bool swings = mean <= load.scatter.deviation;
            const double now = std::abs(history.back());
            const bool told = own > 0 && (!swings || now > 0.2 * load.scatter.deviation);
            per_newton_[quantity] = told ? (swings ? now : mean) / own : 0;
            if (!swings) {
                load.sigma = load.scatter.standard_uncertainty / mean * own;
            }
            settled_.loads.push_back(std::move(load));
        }
    }

    /// Monitors that swing about zero and show no unit by themselves have that of another monitor of forces, or of
    /// moments, in a unit of its own; those for which there is none say nothing.
    void find_units_of_swings() {
        const auto moment = [](const std::string& quantity) { return quantity.ends_with("_moment"); };
        const auto unit_like = [&](const std::string& quantity) {
            const auto found = std::find_if(per_newton_.begin(), per_newton_.end(), [&](const auto& other) {
                return other.second > 0 && moment(other.first) == moment(quantity);
            });
            return found == per_newton_.end() ? 0 : found->second;
        };
        std::erase_if(settled_.loads, [&](LoadHistory& load) {
            const auto known = per_newton_.find(load.quantity);
            if (known == per_newton_.end() || std::abs(load.scatter.mean) > load.scatter.deviation) {
                return false;
            }
            const bool nought = load.scatter.mean == 0 && load.scatter.deviation == 0;
            const double unit = known->second > 0 ? known->second : unit_like(load.quantity);
            if (!(unit > 0) && !nought) {
                without_unit_ = load.quantity;
                return true;
            }
            swing_unit_[load.quantity] = unit;
            load.sigma = unit > 0 ? load.scatter.standard_uncertainty / unit : 0;
            return false;
        });
    }

    /// What the history's drift and scatter count against, in the history's unit; 0: nothing that it could.
    [[nodiscard]] double scale_of(const LoadHistory& load) const {
        const double force = force_ * (load.quantity.ends_with("_moment") ? result_.length : 1);
        if (const auto swing = swing_unit_.find(load.quantity); swing != swing_unit_.end()) {
            return swing->second * force;
        }
        if (!per_newton_.contains(load.quantity)) {
            const bool known_unit = load.sigma > 0;
            return known_unit ? std::max(force * load.scatter.standard_uncertainty / load.sigma,
                                         rounding * std::abs(load.scatter.mean))
                              : std::max(force, std::abs(load.scatter.mean));
        }
        const double own = std::abs(load_of(result_, load.quantity));
        return own > 0 ? std::abs(load.scatter.mean) * force / own : std::abs(load.scatter.mean);
    }

    [[nodiscard]] std::optional<ResidualLevel> highest_residual() const {
        if (settled_.residuals.empty()) {
            return {};
        }
        return *std::max_element(
            settled_.residuals.begin(), settled_.residuals.end(), [](const ResidualLevel& a, const ResidualLevel& b) {
                return (std::isfinite(a.last) ? a.last : HUGE_VAL) < (std::isfinite(b.last) ? b.last : HUGE_VAL);
            });
    }

    [[nodiscard]] std::string settled_loads() const {
        double worst = 0;
        std::string name;
        for (const auto& load : settled_.loads) {
            const double scale = scale_of(load);
            const double share = scale > 0 ? load.scatter.deviation / scale : 0;
            if (name.empty() || share > worst) {
                worst = share;
                name = load.quantity;
            }
        }
        return std::to_string(settled_.loads.size()) + (settled_.loads.size() == 1 ? " history" : " histories") +
               ": no drift, " + name + " scatters by " + percent(worst) + " of the force" +
               (settled_.transient ? "" : " (" + percent(settled_scatter) + " are allowed)");
    }

    static constexpr double rounding = 1e-9;
    const LoadsResult& result_;
    core::Problems& notes_;
    double force_ = 0;
    Settled settled_;
    std::set<std::string> files_;
    std::map<std::string, double> per_newton_;  ///< of histories whose unit nobody states: units a N (N m); 0: unknown
    std::map<std::string, double> swing_unit_;  ///< likewise, of those that swing about zero
    std::string without_unit_;  ///< a quantity whose history says nothing, because its unit is not known
    std::vector<std::string> not_finite_;
    bool short_ = false;
};

}  // namespace

std::string to_string(SettledVerdict verdict) {
    return verdict == SettledVerdict::settled       ? "settled"
           : verdict == SettledVerdict::not_settled ? "not settled"
                                                    : "unknown";
}

std::string fault_of(const IterationScatter& history, double force, bool transient) {
    constexpr double rounding = 1e-9;  // what symmetry makes nought leaves rests that never settle
    if (std::abs(history.mean) + history.deviation + std::abs(history.drift) <= rounding * force) {
        return {};
    }
    const auto of_force = [&](double value) {
        return force > 0 ? " (" + percent(std::abs(value) / force) + " of the force)" : "";
    };
    const std::string over = " over the last " + std::to_string(history.count) + " values";
    if (!history.settled) {
        return "drifts by " + core::format_number(history.drift, 3) + of_force(history.drift) + over;
    }
    if (!transient && force > 0 && history.deviation > settled_scatter * force) {
        return "scatters by " + core::format_number(history.deviation, 3) + of_force(history.deviation) + over;
    }
    return {};
}

Settled settled_by(const LoadsResult& result, const std::vector<StatedLoad>& stated, const fs::path& file,
                   core::Problems& notes) {
    Judge judge(result, notes);
    judge.take(stated);
    for (const auto& history : histories_beside(file)) {
        judge.read(history);
    }
    return judge.verdict();
}

void to_json(nlohmann::json& json, const Settled& settled) {
    json = {{"verdict", to_string(settled.verdict)},
            {"why", settled.why},
            {"transient", settled.transient},
            {"loads", nlohmann::json::object()},
            {"residuals", nlohmann::json::array()}};
    for (const auto& load : settled.loads) {
        json["loads"][load.quantity] = load.scatter;
        json["loads"][load.quantity]["file"] = load.file;
        json["loads"][load.quantity]["sigma"] = load.sigma;
        // What the verdict rests on; that of the scatter alone knows neither the force nor what of it may scatter.
        json["loads"][load.quantity]["stationary"] = load.scatter.settled;
        json["loads"][load.quantity]["settled"] = load.fault.empty();
        json["loads"][load.quantity]["why_not"] = load.fault;
    }
    for (const auto& level : settled.residuals) {
        json["residuals"].push_back(
            {{"equation", level.equation}, {"last", level.last}, {"decades", level.decades}, {"file", level.file}});
    }
}

}  // namespace underbody::postproc
