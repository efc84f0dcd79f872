/* Which of the processor's instruction sets a kernel may be chosen for. Internal. */
#ifndef CT_INSTRUCTIONS_H
#define CT_INSTRUCTIONS_H

/* Each holds those before it; `scalar` asks for one number at a time, whatever the processor has. */
typedef enum ct_instructions {
  CT_INSTRUCTIONS_SCALAR,
  CT_INSTRUCTIONS_GENERIC,
  CT_INSTRUCTIONS_FMA,
  CT_INSTRUCTIONS_AVX2,
  CT_INSTRUCTIONS_AVX512,
  CT_INSTRUCTIONS_NATIVE /* as a cap: no cap */
} ct_instructions;

/* The best that the processor has and the cap allows. */
ct_instructions ct_instructions_usable(ct_instructions cap);

#endif
