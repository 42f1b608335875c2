#include "cases/stored_index.h"

#include <algorithm>

namespace underbody::cases {

namespace {

constexpr std::size_t piece = 1 << 16;  // bytes: what malloc does not ask the system for by itself

}  // namespace

StoredIndex::StoredIndex(Store& store) {
    store.for_each_result([this](const Store::Texts& texts) {
        const std::string_view place = keep({texts.kind, "\n", texts.name});
        Row& row = rows_.emplace_back();
        row.id = texts.id;
        row.kind = place.substr(0, texts.kind.size());
        row.name = place.substr(texts.kind.size() + 1);
        row.key = keep({texts.key});
        row.inputs = keep({texts.inputs});
        row.summary = keep({texts.summary});
        const auto [newest, first] = newest_.try_emplace(place, &row);
        if (!first) {
            row.older = newest->second;
            newest->second = &row;
        }
    });
}

const StoredIndex::Row* StoredIndex::newest(std::string_view kind, std::string_view name) const {
    std::string place;
    place.reserve(kind.size() + 1 + name.size());
    ((place += kind) += '\n') += name;
    const auto found = newest_.find(place);
    return found == newest_.end() ? nullptr : found->second;
}

std::string_view StoredIndex::keep(std::initializer_list<std::string_view> parts) {
    std::size_t size = 0;
    for (const auto part : parts) {
        size += part.size();
    }
    if (size > left_) {
        left_ = std::max(size, piece);
        pieces_.push_back(std::make_unique_for_overwrite<char[]>(left_));
        free_ = pieces_.back().get();
    }
    const char* begin = free_;
    for (const auto part : parts) {
        free_ = std::copy(part.begin(), part.end(), free_);
    }
    left_ -= size;
    return {begin, size};
}

}  // namespace underbody::cases
