#include "near/within.h"
typedef long double R;
static R dot(const R *a, const R *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static R point_segment(const double *p, const double *a, const double *b)
{
    R e[3], v[3], l, t; int k;
    for (k = 0; k < 3; k++) { e[k] = (R)b[k] - a[k]; v[k] = (R)p[k] - a[k]; }
    l = dot(e, e); t = l > 0 ? dot(v, e) / l : 0; t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (k = 0; k < 3; k++) v[k] -= t * e[k];
    return dot(v, v);
}
int sc_within_vertex_face(const double p[4][3], double distance)
{
    R m = point_segment(p[0], p[1], p[2]), x, e[3], f[3], v[3], n[3], nn; int k;
    x = point_segment(p[0], p[2], p[3]); if (x < m) m = x;
    x = point_segment(p[0], p[3], p[1]); if (x < m) m = x;
    for (k = 0; k < 3; k++) { e[k] = (R)p[2][k] - p[1][k]; f[k] = (R)p[3][k] - p[1][k]; v[k] = (R)p[0][k] - p[1][k]; }
    for (k = 0; k < 3; k++) n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    nn = dot(n, n);
    if (nn > 0) {
        R ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), ev = dot(e, v), fv = dot(f, v);
        R s = ff * ev - ef * fv, t = ee * fv - ef * ev;
        if (s >= 0 && t >= 0 && s + t <= nn) { R h = dot(v, n); x = h * h / nn; if (x < m) m = x; }
    }
    return m <= (R)distance * distance;
}
int sc_within_edge_edge(const double p[4][3], double distance)
{
    R m = point_segment(p[0], p[2], p[3]), x, e[3], f[3], v[3], n[3], nn; int k;
    x = point_segment(p[1], p[2], p[3]); if (x < m) m = x;
    x = point_segment(p[2], p[0], p[1]); if (x < m) m = x;
    x = point_segment(p[3], p[0], p[1]); if (x < m) m = x;
    for (k = 0; k < 3; k++) { e[k] = (R)p[1][k] - p[0][k]; f[k] = (R)p[3][k] - p[2][k]; v[k] = (R)p[0][k] - p[2][k]; }
    for (k = 0; k < 3; k++) n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    nn = dot(n, n);
    if (nn > 0) {
        R ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), ev = dot(e, v), fv = dot(f, v);
        R s = ef * fv - ff * ev, t = ee * fv - ef * ev;
        if (s >= 0 && s <= nn && t >= 0 && t <= nn) { R h = dot(v, n); x = h * h / nn; if (x < m) m = x; }
    }
    return m <= (R)distance * distance;
}
