#include "studio/desktop/natural_order.h"

#include <QCollator>

namespace underbody::studio {

bool natural_less(const QString& a, const QString& b) {
    static const QCollator natural = [] {
        QCollator collator(QLocale(QLocale::English));  // the C locale cannot
        collator.setNumericMode(true);
        return collator;
    }();
    return natural.compare(a, b) < 0;
}

}  // namespace underbody::studio
