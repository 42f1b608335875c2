// A number as it stands in sentences of the window: a true minus, a dash for none.
#pragma once

#include <QString>
#include <cmath>

#include "core/text.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

inline QString map_number(double value, int digits = 4) {
    return std::isnan(value) ? QString("–") : qt(core::format_number(value, digits)).replace('-', QChar(0x2212));
}

}  // namespace underbody::studio
