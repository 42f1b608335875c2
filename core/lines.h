// Texts line by line.
#pragma once

#include <cstdint>
#include <string_view>
#include <utility>

#include "core/text.h"

namespace underbody::core {

/// Calls `work(number, line)` for every line that holds anything, without the blanks around it; the first has number 1.
template <class Work>
void for_each_line(std::string_view text, Work&& work) {
    std::int64_t number = 0;
    for (const auto raw : split(text, '\n')) {
        ++number;
        if (const auto line = trimmed(raw); !line.empty()) {
            std::forward<Work>(work)(number, line);
        }
    }
}

}  // namespace underbody::core
