#include "surrogates/dynamics/logs/log_summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/no_limit.h"
#include "core/quantile.h"

namespace underbody::dynamics {

namespace {

class SummarySink : public LogSink {
public:
    bool begin(std::size_t series, const LogSeries& description) override {
        Gathered& own = all_[series];
        own.summary.name = description.name;
        own.summary.type = description.type;
        for (const LogField& field : description.fields) {
            own.summary.fields.push_back({field.name, field.unit, std::nan(""), std::nan("")});
        }
        return true;
    }
    void row(std::size_t series, double time, std::span<const double> values) override {
        Gathered& own = all_[series];
        own.times.push_back(time);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (std::isfinite(values[i])) {
                LogFieldSummary& field = own.summary.fields[i];
                field.min = std::fmin(field.min, values[i]);
                field.max = std::fmax(field.max, values[i]);
            }
        }
    }
    std::vector<LogSeriesSummary> finished() {
        std::vector<LogSeriesSummary> made;
        for (auto& [series, own] : all_) {
            finish(own);
            made.push_back(std::move(own.summary));
        }
        std::sort(made.begin(), made.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
        return made;
    }

private:
    struct Gathered {
        LogSeriesSummary summary;
        std::vector<double> times;
    };
    static void finish(Gathered& own) {
        LogSeriesSummary& summary = own.summary;
        const std::vector<double>& times = own.times;
        summary.count = times.size();
        if (times.empty()) {
            return;
        }
        const auto [first, last] = std::minmax_element(times.begin(), times.end());
        summary.first = *first;
        summary.last = *last;
        const double usual = core::usual_step(times);
        if (usual == 0) {
            return;
        }
        summary.rate = 1 / usual;
        for (std::size_t i = 1; i < times.size(); ++i) {
            if (times[i] - times[i - 1] > 5 * usual) {
                summary.silences.push_back({times[i - 1], times[i]});
            }
        }
        std::stable_sort(summary.silences.begin(), summary.silences.end(),
                         [](const auto& a, const auto& b) { return a.to - a.from > b.to - b.from; });
        summary.silence_count = summary.silences.size();
        summary.silences.resize(std::min<std::size_t>(summary.silences.size(), 8));
    }
    std::map<std::size_t, Gathered> all_;
};

nlohmann::json number(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); }

}  // namespace

LogSummary summarise_log(const std::filesystem::path& log, core::Progress& progress) {
    SummarySink sink;
    LogSummary summary;
    summary.file = log.string();
    summary.end = read_log(log, sink, progress);
    summary.series = sink.finished();
    double first = core::no_limit, last = -core::no_limit;
    for (const LogSeriesSummary& one : summary.series) {
        first = one.count > 0 ? std::min(first, one.first) : first;
        last = one.count > 0 ? std::max(last, one.last) : last;
    }
    summary.duration = std::max(0.0, last - first);
    return summary;
}

void to_json(nlohmann::json& json, const LogSummary& summary) {
    nlohmann::json series = nlohmann::json::array();
    for (const LogSeriesSummary& one : summary.series) {
        nlohmann::json fields = nlohmann::json::array(), silences = nlohmann::json::array();
        for (const LogFieldSummary& field : one.fields) {
            fields.push_back(
                {{"name", field.name}, {"unit", field.unit}, {"min", number(field.min)}, {"max", number(field.max)}});
        }
        for (const auto& silence : one.silences) {
            silences.push_back({{"from", silence.from}, {"to", silence.to}});
        }
        series.push_back({{"name", one.name},
                          {"type", one.type},
                          {"count", one.count},
                          {"first", one.first},
                          {"last", one.last},
                          {"rate", one.rate},
                          {"silences", silences},
                          {"silence_count", one.silence_count},
                          {"fields", fields}});
    }
    nlohmann::json unread = nlohmann::json::array(), problems = nlohmann::json::array();
    for (const UnreadMessages& one : summary.end.unread) {
        unread.push_back({{"name", one.name}, {"type", one.type}, {"reason", one.reason}, {"count", one.count}});
    }
    for (const core::Problem& one : summary.end.problems) {
        problems.push_back({{"message", one.message}});
    }
    json = {{"file", summary.file},
            {"format", summary.end.format},
            {"clock", summary.end.clock},
            {"start_ns", summary.end.start},
            {"duration", summary.duration},
            {"messages", series},
            {"unread", unread},
            {"problems", problems}};
}

}  // namespace underbody::dynamics
