#include "studio/desktop/state/measured.h"

#include "core/text.h"
#include "studio/desktop/state/action_parts.h"
#include "studio/desktop/state/known_things.h"

namespace underbody::studio {

cases::NewMeasurement new_measurement(const std::string& name, const MeasuredRecord& record) {
    cases::NewMeasurement measurement;
    measurement.name = name;
    measurement.model = record.model;
    measurement.data.assign(record.data.begin(), record.data.end());
    for (const auto& channel : record.channels) {
        measurement.channels.push_back(cases::measured_channel(channel));
    }
    const auto colon = record.clock.rfind(':');
    measurement.clock = record.clock.substr(0, colon);
    measurement.clock_unit = colon == std::string::npos ? "" : record.clock.substr(colon + 1);
    return measurement;
}

Words words_of_measurement(const std::string& name, const MeasuredRecord& record) {
    Words words = {"measure", name, "model=" + record.model};
    for (const auto& path : record.data) {
        words.push_back("data=" + path);
    }
    for (const auto& channel : record.channels) {
        words.push_back("channel=" + channel);
    }
    if (!record.clock.empty()) {
        words.push_back("clock=" + record.clock);
    }
    return words;
}

Words command_of_measurement(const std::filesystem::path& study, const std::string& name,
                             const MeasuredRecord& record) {
    Words line = {"underbody", "study", "add", study.string(), "--data"};
    line.insert(line.end(), record.data.begin(), record.data.end());
    line.insert(line.end(), {"--model", record.model, "--name", name});
    for (const auto& channel : record.channels) {
        line.insert(line.end(), {"--channel", channel});
    }
    if (!record.clock.empty()) {
        line.insert(line.end(), {"--clock", record.clock});
    }
    return line;
}

namespace action {

/// Whether the data can be read is found where they are taken in; here the words are looked at.
State measure(State state, const Words& words, const Session&) {
    need(words, 3, 1000, "measure NAME model=FILE data=FILE ... channel=gap=rng_cm:cm clock=t_ms:ms");
    if (state.study.empty()) {
        throw core::UsageError("missing", "there is no study that the measurement could go into", {},
                               "open one first: open FOLDER");
    }
    MeasuredRecord record;
    for (std::size_t i = 1; i < words.size(); ++i) {
        const auto [key, text] = assignment(words[i]);
        if (key == "model") {
            record.model = existing_path(text);
        } else if (key == "data") {
            record.data.push_back(existing_path(text));
        } else if (key == "channel") {
            record.channels.push_back(cases::text_of(cases::measured_channel(text)));
        } else if (key == "clock") {
            record.clock = text;
        } else {
            unknown_key(key, {"model", "data", "channel", "clock"});
        }
    }
    if (words[0].empty() || record.model.empty() || record.data.empty()) {
        throw core::UsageError("words", "a measurement needs a name, a model and data", {},
                               "measure NAME model=FILE data=FILE");
    }
    const auto [known, fresh] = state.measured.try_emplace(words[0], record);
    if (!fresh && !(known->second == record)) {
        throw core::UsageError("exists", "there is a measurement '" + words[0] + "' already", {}, "take another name");
    }
    state.selection = {"measurement/" + words[0]};
    state.last["measurement"] = {words[0]};
    state.workspace = "loop";
    return state;
}

}  // namespace action
}  // namespace underbody::studio
