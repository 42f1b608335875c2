// A table of forces for the open study, made of its cases: quantity, axes, what is held, net weight, and the command
// that does the same. Nothing is written before "Make it".
#pragma once

#include <QDialog>

#include "cases/add_table.h"
#include "studio/desktop/state/words.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;

namespace underbody::studio {

class TableSheet : public QDialog {
    Q_OBJECT
public:
    explicit TableSheet(const cases::Study& study, QWidget* parent);

    [[nodiscard]] QComboBox* quantity() const { return quantity_; }
    [[nodiscard]] QLineEdit* held() const { return held_; }
    [[nodiscard]] QLineEdit* axes() const { return axes_; }
    [[nodiscard]] QLineEdit* net_weight() const { return net_weight_; }
    /// `underbody study add STUDY --table ...`
    [[nodiscard]] Words command() const;
    /// What is wrong with what stands there; empty: it can be made.
    [[nodiscard]] QString wrong() const { return wrong_; }

public Q_SLOTS:
    /// Writes study.toml and tells `made`.
    void accept() override;

Q_SIGNALS:
    void made(const QString& table, const QString& command);
    void failed(const QString& what, std::exception_ptr error);

private:
    [[nodiscard]] cases::NewTable wanted() const;
    void follow();

    cases::Study study_;
    QComboBox* quantity_ = nullptr;
    QLineEdit *held_ = nullptr, *axes_ = nullptr, *net_weight_ = nullptr, *name_ = nullptr;
    QLabel* said_ = nullptr;
    QPushButton* make_ = nullptr;
    QString wrong_;
};

}  // namespace underbody::studio
