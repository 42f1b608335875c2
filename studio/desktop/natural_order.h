// Names as people count them: h2 before h10.
#pragma once

#include <QString>
#include <vector>

namespace underbody::studio {

[[nodiscard]] bool natural_less(const QString& a, const QString& b);

/// The place of each name in that order, equal ones in the order they come in: for very many, each is looked at once.
[[nodiscard]] std::vector<int> natural_ranks(const std::vector<QString>& names);

}  // namespace underbody::studio
