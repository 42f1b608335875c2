#include "studio/desktop/natural_order.h"

#include <QCollator>
#include <algorithm>
#include <numeric>
#include <tuple>

namespace underbody::studio {

namespace {

const QCollator& natural() {
    static const QCollator made = [] {
        QCollator collator(QLocale(QLocale::English));  // the C locale cannot
        collator.setNumericMode(true);
        std::ignore =
            collator.compare(QString("a"), QString("b"));  // it is made ready at its first use, not by two threads
        return collator;
    }();
    return made;
}

/// The digits behind a decimal point count one by one, and behind whatever else follows the number: 1mm, 1.25mm, 1.5mm.
QString by_value(const QString& name) {
    QString text;
    bool fraction = false;
    for (int i = 0; i < name.size(); ++i) {
        const bool digit = name[i].isDigit();
        const bool point = !fraction && name[i] == '.' && i > 0 && name[i - 1].isDigit() && i + 1 < name.size() &&
                           name[i + 1].isDigit();
        fraction = point || (fraction && digit);
        if (!point) {
            text += fraction ? QString("zz") + name[i] : QString(name[i]);
        }
    }
    return text;
}

}  // namespace

bool natural_less(const QString& a, const QString& b) { return natural().compare(by_value(a), by_value(b)) < 0; }

std::vector<int> natural_ranks(const std::vector<QString>& names) {
    std::vector<QCollatorSortKey> keys;
    keys.reserve(names.size());
    for (const QString& name : names) {
        keys.push_back(natural().sortKey(by_value(name)));
    }
    std::vector<int> order(names.size()), ranks(names.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        return keys[static_cast<std::size_t>(a)].compare(keys[static_cast<std::size_t>(b)]) < 0;
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
        ranks[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
    }
    return ranks;
}

}  // namespace underbody::studio
