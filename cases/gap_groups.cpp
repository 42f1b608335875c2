#include "cases/gap_groups.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

namespace underbody::cases {

namespace {

/// The conditions but the gap that are not the same in all of `entries`.
std::set<std::string> varying(const std::vector<const Conditions*>& entries) {
    std::set<std::string> names;
    const auto differs = [&](const Conditions& one) {
        return std::any_of(entries.begin(), entries.end(), [&](const auto* other) { return !other->satisfies(one); });
    };
    for (const auto* entry : entries) {
        for (const auto& [name, value] : entry->numbers) {
            Conditions one;
            one.set(name, value);
            if (name != "gap" && differs(one)) {
                names.insert(name);
            }
        }
        for (const auto& [name, text] : entry->texts) {
            Conditions one;
            one.texts = {{name, text}};
            if (differs(one)) {
                names.insert(name);
            }
        }
    }
    return names;
}

Conditions only(Conditions all, const std::set<std::string>& names) {
    std::erase_if(all.numbers, [&](const auto& one) { return !names.contains(one.first); });
    std::erase_if(all.texts, [&](const auto& one) { return !names.contains(one.first); });
    return all;
}

}  // namespace

std::vector<GapGroup> gap_groups(const std::vector<const Conditions*>& entries) {
    std::vector<const Conditions*> with_gap;
    std::copy_if(entries.begin(), entries.end(), std::back_inserter(with_gap),
                 [](const Conditions* one) { return one->number("gap").has_value(); });
    const std::set<std::string> names = varying(with_gap);
    std::vector<GapGroup> groups;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (!entries[i]->number("gap")) {
            continue;
        }
        const Conditions held = only(*entries[i], names);
        auto at = std::find_if(groups.begin(), groups.end(), [&](const GapGroup& group) {
            return group.held.satisfies(held) && held.satisfies(group.held);
        });
        if (at == groups.end()) {
            at = groups.insert(groups.end(), {held, {}});
        }
        at->cases.push_back(i);
    }
    return groups;
}

Conditions held_by_fullest(const std::vector<GapGroup>& groups) {
    const auto tells = [](const GapGroup& group) { return group.held.numbers.size() + group.held.texts.size(); };
    const auto most = std::max_element(groups.begin(), groups.end(), [&](const GapGroup& a, const GapGroup& b) {
        return std::pair(tells(a), a.cases.size()) < std::pair(tells(b), b.cases.size());
    });
    return most == groups.end() ? Conditions() : most->held;
}

}  // namespace underbody::cases
