// Names as people count them: h2 before h10.
#pragma once

#include <QString>

namespace underbody::studio {

[[nodiscard]] bool natural_less(const QString& a, const QString& b);

}  // namespace underbody::studio
