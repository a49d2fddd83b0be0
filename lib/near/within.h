#ifndef SC_NEAR_WITHIN_H
#define SC_NEAR_WITHIN_H
int sc_within_vertex_face(const double p[4][3], double distance);
int sc_within_edge_edge(const double p[4][3], double distance);
#endif
