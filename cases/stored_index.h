// All results of a store by kind and name, to look up those of ten thousand cases.
#pragma once

#include <deque>
#include <memory>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "cases/store.h"

namespace underbody::cases {

/// The texts lie one behind the other in a few pieces of memory: as strings of their own, five a result, they cost more
/// to make and to forget than to read.
class StoredIndex {
public:
    struct Row : Store::Texts {
        const Row* older = nullptr;  ///< the one before of this kind and name
    };

    StoredIndex() = default;
    explicit StoredIndex(Store& store);
    StoredIndex(const StoredIndex&) = delete;
    StoredIndex& operator=(const StoredIndex&) = delete;

    /// The newest result of that kind and name; nullptr: none.
    [[nodiscard]] const Row* newest(std::string_view kind, std::string_view name) const;

private:
    /// A copy that stays as long as the index.
    std::string_view keep(std::initializer_list<std::string_view> parts);

    std::vector<std::unique_ptr<char[]>> pieces_;
    std::size_t left_ = 0;  ///< of the last piece
    char* free_ = nullptr;
    std::deque<Row> rows_;
    std::unordered_map<std::string_view, const Row*> newest_;  ///< by kind, line end and name
};

}  // namespace underbody::cases
