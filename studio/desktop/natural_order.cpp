#include "studio/desktop/natural_order.h"

#include <QCollator>
#include <tuple>

namespace underbody::studio {

bool natural_less(const QString& a, const QString& b) {
    static const QCollator natural = [] {
        QCollator collator(QLocale(QLocale::English));  // the C locale cannot
        collator.setNumericMode(true);
        std::ignore =
            collator.compare(QString("a"), QString("b"));  // it is made ready at its first use, not by two threads
        return collator;
    }();
    return natural.compare(a, b) < 0;
}

}  // namespace underbody::studio
