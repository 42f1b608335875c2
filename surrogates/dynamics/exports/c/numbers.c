/* Numbers with their derivative along one direction: what is computed with them gives both, exactly. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    double v, d;
} num;

static num con(double v) {
    num r;
    r.v = v;
    r.d = 0;
    return r;
}
static num with_slope(num x, double value, double slope) {
    num r;
    r.v = value;
    r.d = slope * x.d;
    return r;
}
static num add(num a, num b) {
    a.v += b.v;
    a.d += b.d;
    return a;
}
static num sub(num a, num b) {
    a.v -= b.v;
    a.d -= b.d;
    return a;
}
static num mul(num a, num b) {
    num r;
    r.v = a.v * b.v;
    r.d = a.d * b.v + a.v * b.d;
    return r;
}
static num quo(num a, num b) {
    num r;
    r.v = a.v / b.v;
    r.d = (a.d - r.v * b.d) / b.v;
    return r;
}
static num times(double f, num a) {
    a.v *= f;
    a.d *= f;
    return a;
}
static num plus(num a, double b) {
    a.v += b;
    return a;
}
static num sine(num a) { return with_slope(a, sin(a.v), cos(a.v)); }
static num cosine(num a) { return with_slope(a, cos(a.v), -sin(a.v)); }
static num root(num a) {
    const double r = sqrt(a.v);
    return with_slope(a, r, r > 0 ? 0.5 / r : 0);
}
static num size_of_num(num a) { return with_slope(a, fabs(a.v), a.v < 0 ? -1 : 1); }
/* a where a > lower, else lower. */
static num at_least(num a, double lower) { return a.v > lower ? a : con(lower); }
static num between(num a, double lower, double upper) {
    return a.v < lower ? con(lower) : a.v > upper ? con(upper) : a;
}
