/* SPDX-FileCopyrightText: 2026 The satvib authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * As much of libcomedi as the back end calls, with two boards of the paper's kind: 16 inputs, 2 outputs, 12 bit.
 * The test sets what inputs read and which call fails, and reads what was written and called. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

typedef struct { double min, max; unsigned unit; } comedi_range;
typedef struct { unsigned inputs[16], outputs[2]; int open, locked; } board;

static board boards[2];
static comedi_range ranges[2] = {{-10, 10, 0}, {-5, 5, 0}};
static int last_errno, oor;
static char calls[65536], failing[64];

static int fails(const char *name, int number) {
  if (strcmp(failing, name)) return 0;
  last_errno = number;
  return 1;
}
static void note(const char *text) {
  if (strlen(calls) + strlen(text) + 2 < sizeof calls) { strcat(calls, text); strcat(calls, ";"); }
}

void stub_reset(void) {
  memset(boards, 0, sizeof boards);
  for (int b = 0; b < 2; b++) for (int i = 0; i < 2; i++) boards[b].outputs[i] = 3500; /* as a killed writer left it */
  calls[0] = failing[0] = 0;
}
void stub_input(int b, int channel, unsigned code) { boards[b].inputs[channel] = code; }
unsigned stub_output(int b, int channel) { return boards[b].outputs[channel]; }
int stub_open(int b) { return boards[b].open; }
int stub_locked(int b) { return boards[b].locked; }
int stub_oor(void) { return oor; }
void stub_fail(const char *name) { snprintf(failing, sizeof failing, "%s", name); }
const char *stub_calls(void) { return calls; }

void *comedi_open(const char *file) {
  char text[128];
  snprintf(text, sizeof text, "open %s", file);
  note(text);
  int b = !strcmp(file, "/dev/comedi0") ? 0 : !strcmp(file, "/dev/comedi1") ? 1 : -1;
  if (b < 0) { last_errno = ENOENT; return NULL; }
  boards[b].open = 1;
  return &boards[b];
}
int comedi_close(void *d) { note("close"); ((board *)d)->open = 0; return 0; }
int comedi_errno(void) { return last_errno; }
const char *comedi_strerror(int number) { return strerror(number); }
int comedi_set_global_oor_behavior(int behavior) { oor = behavior; return 0; }
const char *comedi_get_board_name(void *d) { (void)d; return "pci-6025e"; }
int comedi_find_subdevice_by_type(void *d, int type, unsigned start) { (void)d; (void)start; return type - 1; }
int comedi_get_n_channels(void *d, unsigned s) { (void)d; return s == 0 ? 16 : 2; }
unsigned comedi_get_maxdata(void *d, unsigned s, unsigned c) { (void)d; (void)s; (void)c; return 4095; }
int comedi_find_range(void *d, unsigned s, unsigned c, unsigned unit, double min, double max) {
  (void)d; (void)c; (void)unit;
  for (int i = 0; i < 2; i++)
    if (ranges[i].min == min && ranges[i].max == max && (s == 0 || i == 0)) return i;
  last_errno = EINVAL;
  return -1;
}
comedi_range *comedi_get_range(void *d, unsigned s, unsigned c, unsigned r) { (void)d; (void)s; (void)c; return &ranges[r]; }
double comedi_to_phys(unsigned data, comedi_range *r, unsigned maxdata) {
  return r->min + (r->max - r->min) * data / maxdata;
}
unsigned comedi_from_phys(double volts, comedi_range *r, unsigned maxdata) {
  double code = (volts - r->min) / (r->max - r->min) * maxdata;
  return code < 0 ? 0 : code > maxdata ? maxdata : (unsigned)(code + 0.5);
}
int comedi_data_read(void *d, unsigned s, unsigned c, unsigned r, unsigned aref, unsigned *data) {
  char text[64];
  snprintf(text, sizeof text, "read %u %u %u %u", s, c, r, aref);
  note(text);
  if (fails("comedi_data_read", EIO)) return -1;
  *data = ((board *)d)->inputs[c];
  return 1;
}
int comedi_data_write(void *d, unsigned s, unsigned c, unsigned r, unsigned aref, unsigned data) {
  char text[64];
  snprintf(text, sizeof text, "write %d %u %u %u %u %u", (int)((board *)d - boards), s, c, r, aref, data);
  note(text);
  if (fails("comedi_data_write", EIO) && c == 0) return -1;
  ((board *)d)->outputs[c] = data;
  return 1;
}
int comedi_lock(void *d, unsigned s) {
  note("lock");
  (void)s;
  if (fails("comedi_lock", EBUSY)) return -1;
  ((board *)d)->locked = 1;
  return 0;
}
int comedi_unlock(void *d, unsigned s) { note("unlock"); (void)s; ((board *)d)->locked = 0; return 0; }
