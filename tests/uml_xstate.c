// Preloaded into user-mode Linux, lets its guest run where the host keeps more registers than the guest knows of.
//
// The guest saves and restores the extended registers of its processes by ptrace, in the layout of XSAVE, and its
// area for them has a fixed size of some 2.7 kB. A kernel hands out as much of its own area as fits, but takes
// back only a whole one. With AMX, whose tiles alone are 8 kB, every restore is then refused with EFAULT.
//
// Here a restore that is too short is made whole: what the guest never had is put into its initial state. All other
// requests, and all restores where the guest's area is large enough, pass as they are.

#define _GNU_SOURCE
#include <cpuid.h>
#include <dlfcn.h>
#include <elf.h>
#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

enum {
    XSAVE_LEAF = 0xD,                     // of CPUID: where in the layout a component lies
    FIRST_EXTENDED = 2, COMPONENTS = 64,  // x87 and SSE, 0 and 1, lie in the first 512 bytes
    XSTATE_BV = 512,                      // where the header says which components are not in their initial state
    HEADER_END = 576,
    LARGEST = 1 << 18,                    // far above any processor's area
};

typedef long ptrace_function(enum __ptrace_request, ...);

static ptrace_function *next_ptrace;
static uint32_t component_end[COMPONENTS];
static char whole[LARGEST];  // static: the guest's kernel has small stacks, and traces from one thread
static size_t whole_size;    // what this kernel wants; 0 until it has been asked

__attribute__((constructor)) static void prepare(void) {
    *(void **)&next_ptrace = dlsym(RTLD_NEXT, "ptrace");
    if (!next_ptrace) {
        fputs("uml_xstate: there is no ptrace to pass requests to\n", stderr);
        abort();
    }
    for (unsigned component = FIRST_EXTENDED; component < COMPONENTS; component++) {
        unsigned size, offset, flags, unused;
        if (__get_cpuid_count(XSAVE_LEAF, component, &size, &offset, &flags, &unused) && size)
            component_end[component] = offset + size;
    }
}

// Asks the kernel for the size of its area, which it tells by how much it hands out. 0 on success, else -1 and errno.
static int learn_size(pid_t pid) {
    struct iovec all = {whole, sizeof whole};
    if (next_ptrace(PTRACE_GETREGSET, pid, NT_X86_XSTATE, &all) < 0)
        return -1;
    if (all.iov_len >= sizeof whole) {  // perhaps only a part of it
        fputs("uml_xstate: this kernel's area of registers is larger than any known\n", stderr);
        errno = EOVERFLOW;
        return -1;
    }
    whole_size = all.iov_len;
    return 0;
}

// Those of the components that lie entirely within so many bytes.
static uint64_t held_within(size_t size, uint64_t components) {
    for (unsigned component = FIRST_EXTENDED; component < COMPONENTS; component++)
        if (component_end[component] > size)
            components &= ~(UINT64_C(1) << component);
    return components;
}

static long restore(pid_t pid, const struct iovec *part) {
    uint64_t components;
    memcpy(whole, part->iov_base, part->iov_len);
    memset(whole + part->iov_len, 0, whole_size - part->iov_len);
    memcpy(&components, whole + XSTATE_BV, sizeof components);
    components = held_within(part->iov_len, components);
    memcpy(whole + XSTATE_BV, &components, sizeof components);
    struct iovec all = {whole, whole_size};
    return next_ptrace(PTRACE_SETREGSET, pid, NT_X86_XSTATE, &all);
}

long ptrace(enum __ptrace_request request, ...) {
    va_list arguments;
    va_start(arguments, request);
    pid_t pid = va_arg(arguments, pid_t);
    void *address = va_arg(arguments, void *);
    void *data = va_arg(arguments, void *);
    va_end(arguments);

    const struct iovec *part = data;
    if (request != PTRACE_SETREGSET || (uintptr_t)address != NT_X86_XSTATE || part->iov_len < HEADER_END)
        return next_ptrace(request, pid, address, data);
    if (!whole_size && learn_size(pid) < 0)
        return -1;
    if (part->iov_len >= whole_size)
        return next_ptrace(request, pid, address, data);
    return restore(pid, part);
}
