/* What C code on Windows needs of a C library besides what Windows has: linked instead of MinGW's, whose hundreds of files
 * take minutes to compile the first time and bring start-up code that a model has no use for. No header is needed. */

#include <stdarg.h>
#include <stddef.h>

/* What Windows calls when the library is loaded; there is nothing to do. */
int __stdcall DllMainCRTStartup(void *instance, unsigned long reason, void *reserved) {
    (void)instance, (void)reason, (void)reserved;
    return 1;
}

/* Windows has the printf family as one function; option 2 makes it count and end its text as C99 says. */
int __stdio_common_vsprintf(unsigned long long options, char *text, size_t size, const char *form, void *locale,
                            va_list values);

int vsnprintf(char *text, size_t size, const char *form, va_list values) {
    return __stdio_common_vsprintf(2, text, size, form, NULL, values);
}

/* MinGW's headers make isfinite, isnan and signbit of these; the numbers are those of its FP_NAN and so on. */
static unsigned long long dp_bits(double x) {
    union {
        double number;
        unsigned long long bits;
    } u;
    u.number = x;
    return u.bits;
}

int __fpclassify(double x) {
    const unsigned long long size = dp_bits(x) & ~0ULL >> 1, one = 1ULL << 52, infinite = 0x7FFULL << 52;
    if (size == 0) return 0x4000;                            /* FP_ZERO */
    if (size < one) return 0x4400;                           /* FP_SUBNORMAL */
    if (size < infinite) return 0x0400;                      /* FP_NORMAL */
    return size == infinite ? 0x0500 : 0x0100;               /* FP_INFINITE, FP_NAN */
}

int __isnan(double x) { return x != x; }

int __signbit(double x) { return (int)(dp_bits(x) >> 63); }
