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

}  // namespace

bool natural_less(const QString& a, const QString& b) { return natural().compare(a, b) < 0; }

std::vector<int> natural_ranks(const std::vector<QString>& names) {
    std::vector<QCollatorSortKey> keys;
    keys.reserve(names.size());
    for (const QString& name : names) {
        keys.push_back(natural().sortKey(name));
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
